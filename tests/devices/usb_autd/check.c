/* Reads what a device is told, a line each, and prints what the decoder makes of it: for tests.

   device UNITS TRANSDUCERS PHASES AMPLITUDES QUEUE SAMPLES LONGEST | arm SESSION | disarm | flush | silence SEQUENCE |
   feed HEX. After each feed: its verdicts; after `end`: accepted refused corrupt skipped lost sequence refusal, and the
   CRC-like sum of the last frame's levels. */
#include "decoder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint8_t line[1 << 20], bytes[1 << 19];

static uint8_t nibble(uint8_t c) { return (uint8_t)(c <= '9' ? c - '0' : c - 'a' + 10); }

int main(void) {
    ua_decoder d;
    ua_capability can;
    uint8_t *buffer = NULL;
    unsigned long sum = 0;
    memset(&d, 0, sizeof d);
    while (fgets((char *)line, sizeof line, stdin)) {
        unsigned v[7];
        if (sscanf((char *)line, "device %u %u %u %u %u %u %u", v, v + 1, v + 2, v + 3, v + 4, v + 5, v + 6) == 7) {
            can = (ua_capability){(uint16_t)v[0], (uint16_t)v[1], (uint16_t)v[2], (uint16_t)v[3],
                                  (uint16_t)v[4], (uint16_t)v[5], v[6]};
            free(buffer);
            buffer = malloc(can.longest); /* exactly: the sanitiser sees a byte too many */
            if (!buffer) return 2;
            ua_init(&d, &can, buffer);
            sum = 0;
        } else if (sscanf((char *)line, "arm %u", v) == 1) {
            ua_arm(&d, v[0]);
        } else if (sscanf((char *)line, "silence %u", v) == 1) {
            ua_silence(&d, v[0]);
        } else if (!strncmp((char *)line, "disarm", 6)) {
            ua_disarm(&d);
        } else if (!strncmp((char *)line, "flush", 5)) {
            ua_flush(&d);
        } else if (!strncmp((char *)line, "feed ", 5)) {
            size_t size = 0;
            for (uint8_t *at = line + 5; at[0] > ' ' && at[1] > ' '; at += 2)
                bytes[size++] = (uint8_t)(nibble(at[0]) << 4 | nibble(at[1]));
            const uint8_t *data = bytes;
            ua_verdict verdict;
            while ((verdict = ua_next(&d, &data, &size)) != UA_MORE) {
                printf("%d ", verdict);
                if (verdict != UA_OK) continue;
                sum = 0;
                uint32_t units = 0;
                for (uint32_t bits = d.frame.units; bits; bits &= bits - 1) units++;
                for (uint32_t i = 0; i < d.frame.rows * units * can.transducers; i++) {
                    const uint8_t *at = d.frame.levels + 3 * i;
                    uint16_t first = ua_scaled(ua_amplitude(at), ua_sample(d.frame.envelope));
                    sum = (sum * 31 + ua_phase(at) * 4096ul + first) & 0xFFFFFFFFul;
                }
            }
            printf("\n");
        } else if (!strncmp((char *)line, "end", 3)) {
            printf("%u %u %u %u %u %u %d %lu\n", d.accepted, d.refused, d.corrupt, d.skipped, d.lost, d.sequence,
                   d.refusal, sum);
        }
    }
    free(buffer);
    return 0;
}
