/* usb-autd 1.0: from a stream of bytes to frames. See docs/usb-autd.md, "Messages".
   C99, no allocation, no system calls; little and big endian machines alike. */
#ifndef PACINIAN_USB_AUTD_DECODER_H
#define PACINIAN_USB_AUTD_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { UA_MAJOR = 1, UA_FRAME = 1, UA_HEAD = 24, UA_BODY = 8, UA_CRC = 4, UA_FULL = 1 << 15 };

/* What became of a message; the numbers are those of the status report. */
typedef enum {
    UA_MORE = -1, /* no message has come to its end: feed more bytes */
    UA_OK = 0,
    UA_VERSION,
    UA_LENGTH,
    UA_CORRUPT,
    UA_KIND,
    UA_UNITS,
    UA_ROWS,
    UA_ENVELOPE,
    UA_LEVEL,
    UA_DISARMED,
    UA_SESSION,
    UA_SEQUENCE
} ua_verdict;

/* What the device can do, as its capability report says. */
typedef struct {
    uint16_t units, transducers, phases, amplitudes, queue, samples;
    uint32_t longest; /* bytes of a message */
} ua_capability;

/* An accepted frame; it lies in the decoder's buffer until ua_next is called again. */
typedef struct {
    uint32_t session, sequence;
    uint16_t units, steps, samples;
    uint8_t rows, lead;
    const uint8_t *envelope; /* samples * 2 bytes */
    const uint8_t *levels;   /* rows * units in the frame * transducers * 3 bytes */
} ua_frame;

typedef struct {
    ua_capability can;
    uint8_t *buffer;  /* can.longest bytes */
    uint32_t have;    /* bytes in it */
    uint32_t done;    /* of those, the message that was handed out last */
    uint32_t session; /* 0: disarmed */
    uint32_t sequence;
    uint32_t accepted, refused, corrupt, skipped, lost;
    ua_verdict refusal; /* the last that was not UA_OK */
    ua_frame frame;
} ua_decoder;

/* A decoder for a device that was just attached: disarmed. buffer: can->longest bytes, at least 36. */
void ua_init(ua_decoder *d, const ua_capability *can, uint8_t *buffer);

/* Requests ARM and DISARM; false: refuse it (STALL). */
bool ua_arm(ua_decoder *d, uint32_t session);
void ua_disarm(ua_decoder *d);

/* Request SILENCE: drop what has not come to its end. The other: with a sequence number. */
void ua_flush(ua_decoder *d);
void ua_silence(ua_decoder *d, uint32_t sequence);

/* Take bytes from *data, as many as can be used, and say what became of the next message; after UA_OK, d->frame.
   Call it again until it says UA_MORE: then *size is 0. */
ua_verdict ua_next(ua_decoder *d, const uint8_t **data, size_t *size);

/* Levels of one transducer, at its three bytes; a sample of an envelope, at its two. */
static inline uint16_t ua_phase(const uint8_t *at) { return (uint16_t)(at[0] | (at[1] & 15u) << 8); }
static inline uint16_t ua_amplitude(const uint8_t *at) { return (uint16_t)(at[1] >> 4 | at[2] << 4); }
static inline uint16_t ua_sample(const uint8_t *at) { return (uint16_t)(at[0] | at[1] << 8); }

/* The amplitude level that is emitted under an envelope. */
static inline uint16_t ua_scaled(uint16_t amplitude, uint16_t sample) {
    return (uint16_t)(((uint32_t)amplitude * sample + UA_FULL / 2) / UA_FULL);
}

#endif
