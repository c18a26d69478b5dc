#include "decoder.h"

#include <string.h>

static const uint8_t MAGIC[4] = {0xA5, 'U', 'A', 'D'};

static uint32_t u16(const uint8_t *at) { return ua_sample(at); }
static uint32_t u32(const uint8_t *at) { return u16(at) | u16(at + 2) << 16; }

/* CRC-32 of IEEE 802.3, four bits at a time; crc: of what came before, 0 at the beginning. */
static uint32_t crc32(uint32_t crc, const uint8_t *data, size_t size) {
    static const uint32_t table[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
        0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};
    crc = ~crc;
    while (size--) {
        crc ^= *data++;
        crc = crc >> 4 ^ table[crc & 15];
        crc = crc >> 4 ^ table[crc & 15];
    }
    return ~crc;
}

static bool newer(uint32_t sequence, uint32_t than) {
    uint32_t ahead = sequence - than;
    return ahead != 0 && ahead < 0x80000000u;
}

static void drop(ua_decoder *d, uint32_t count) {
    d->have -= count;
    memmove(d->buffer, d->buffer + count, d->have);
}

static void skip(ua_decoder *d, uint32_t count) {
    d->skipped += count;
    drop(d, count);
}

void ua_init(ua_decoder *d, const ua_capability *can, uint8_t *buffer) {
    memset(d, 0, sizeof *d);
    d->can = *can;
    d->buffer = buffer;
}

void ua_flush(ua_decoder *d) { d->have = d->done = 0; }

bool ua_arm(ua_decoder *d, uint32_t session) {
    if (session == 0) return false;
    ua_flush(d);
    d->session = session;
    d->sequence = 0;
    return true;
}

void ua_disarm(ua_decoder *d) {
    ua_flush(d);
    d->session = 0;
}

void ua_silence(ua_decoder *d, uint32_t sequence) {
    ua_flush(d);
    if (newer(sequence, d->sequence)) d->sequence = sequence;
}

/* Have the buffer begin with the magic, or as much of it as has come. */
static void find(ua_decoder *d) {
    uint32_t at = 0;
    for (; at < d->have; at++) {
        uint32_t left = d->have - at;
        if (memcmp(d->buffer + at, MAGIC, left < 4 ? left : 4) == 0) break;
    }
    skip(d, at);
}

/* What a message whose CRCs are right says. */
static ua_verdict content(ua_decoder *d, uint32_t length) {
    const uint8_t *m = d->buffer, *body = m + UA_HEAD;
    const ua_capability *can = &d->can;
    ua_frame *f = &d->frame;
    if (m[5] != UA_FRAME) return UA_KIND;
    if (length < UA_HEAD + UA_BODY + UA_CRC) return UA_LENGTH;
    f->session = u32(m + 12);
    f->sequence = u32(m + 16);
    f->units = ua_sample(body);
    f->rows = body[2];
    f->lead = body[3];
    f->steps = ua_sample(body + 4);
    f->samples = ua_sample(body + 6);
    f->envelope = body + UA_BODY;
    f->levels = f->envelope + 2u * f->samples;
    if (f->units == 0 || (uint32_t)f->units >> can->units) return UA_UNITS;
    if (f->rows == 0 || f->rows > f->steps || f->steps + f->lead > can->queue) return UA_ROWS;
    if (f->samples < f->steps || f->samples > can->samples) return UA_ENVELOPE;
    uint32_t units = 0;
    for (uint32_t bits = f->units; bits; bits &= bits - 1) units++;
    uint32_t count = f->rows * units * can->transducers;
    if (length != UA_HEAD + UA_BODY + 2u * f->samples + 3u * count + UA_CRC) return UA_LENGTH;
    for (uint32_t k = 0; k < f->samples; k++)
        if (u16(f->envelope + 2 * k) > UA_FULL) return UA_ENVELOPE;
    for (const uint8_t *at = f->levels; count--; at += 3)
        if (ua_phase(at) >= can->phases || ua_amplitude(at) >= can->amplitudes) return UA_LEVEL;
    return UA_OK;
}

/* Whether a frame whose content is right may sound. */
static ua_verdict admit(ua_decoder *d) {
    if (d->session == 0) return UA_DISARMED;
    if (d->frame.session != d->session) return UA_SESSION;
    if (!newer(d->frame.sequence, d->sequence)) return UA_SEQUENCE;
    d->lost += d->frame.sequence - d->sequence - 1;
    d->sequence = d->frame.sequence;
    d->accepted++;
    return UA_OK;
}

/* The next verdict from what is in the buffer; UA_MORE, and then in *need how many bytes it must hold. */
static ua_verdict look(ua_decoder *d, uint32_t *need) {
    for (;;) {
        find(d);
        *need = UA_HEAD;
        if (d->have < UA_HEAD) return UA_MORE;
        uint32_t check = crc32(0, d->buffer, UA_HEAD - UA_CRC);
        if (check != u32(d->buffer + UA_HEAD - UA_CRC)) {
            skip(d, 1);
            continue;
        }
        uint32_t length = u32(d->buffer + 8);
        ua_verdict verdict = UA_OK;
        if (d->buffer[4] != UA_MAJOR) verdict = UA_VERSION;
        else if (length < UA_HEAD + UA_CRC || length > d->can.longest) verdict = UA_LENGTH;
        if (verdict == UA_OK) {
            *need = length;
            if (d->have < length) return UA_MORE;
            uint32_t end = length - UA_CRC;
            if (crc32(check, d->buffer + UA_HEAD, end - UA_HEAD) == u32(d->buffer + end)) {
                d->done = length;
                verdict = content(d, length);
                return verdict == UA_OK ? admit(d) : verdict;
            }
            verdict = UA_CORRUPT;
        }
        skip(d, 1); /* its length cannot be relied on: look behind its magic */
        return verdict;
    }
}

ua_verdict ua_next(ua_decoder *d, const uint8_t **data, size_t *size) {
    drop(d, d->done);
    d->done = 0;
    for (;;) {
        uint32_t need;
        ua_verdict verdict = look(d, &need);
        if (verdict == UA_MORE) {
            if (*size == 0) return UA_MORE;
            uint32_t count = need - d->have;
            if (count > *size) count = (uint32_t)*size;
            memcpy(d->buffer + d->have, *data, count);
            d->have += count;
            *data += count;
            *size -= count;
            continue;
        }
        if (verdict == UA_CORRUPT) d->corrupt++;
        else if (verdict != UA_OK) d->refused++;
        if (verdict != UA_OK) d->refusal = verdict;
        return verdict;
    }
}
