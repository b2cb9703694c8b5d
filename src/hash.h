/* Hashes of 64 bits. */
#ifndef SRC_HASH_H
#define SRC_HASH_H

#include <stdint.h>
#include <string.h>

/* Every bit of the result depends on every bit that goes in: the finalizer of MurmurHash3. */
static inline uint64_t shb_mix(uint64_t bits) {
    bits = (bits ^ bits >> 33) * 0xff51afd7ed558ccdu;
    bits = (bits ^ bits >> 33) * 0xc4ceb9fe1a85ec53u;
    return bits ^ bits >> 33;
}

/* Of three numbers; 0 and -0 differ. */
static inline uint64_t shb_position_key(const double position[3]) {
    uint64_t key = 0;
    for (int i = 0; i < 3; i++) {
        uint64_t bits;
        memcpy(&bits, &position[i], sizeof bits);
        key = shb_mix(key ^ bits);
    }
    return key;
}

#endif
