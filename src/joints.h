/* Which neighbouring texels of a map that keeps planes hold one sheet: those whose planes meet
 * between the two centres (k_joints.inl). That is found for blocks of texels when filters first ask
 * there. Any number of threads may find the same block at once; all store the same bits. */
#ifndef SRC_JOINTS_H
#define SRC_JOINTS_H

#include "context.h"

#include <stdatomic.h>

/* Texels of a block, and those whose joints are one word. */
#define SHB_JOINT_COLUMNS 64
#define SHB_JOINT_ROWS 16
#define SHB_JOINT_WORD 16

/* Words of texels beyond both ends of a row, which are joined to none: as many as the widest box
 * may reach. */
#define SHB_JOINT_MARGIN 5

typedef struct shb_joints {
    /* row by row. Four bits for each texel, 16 of one kind after the other from the lowest on: it
     * is joined to the next one to the right, to the one below, to the one below that; and the one
     * to the right is joined to the one below. */
    _Atomic uint64_t *words;
    size_t pitch;           /* words in a row */
    _Atomic uint8_t *found; /* blocks, row by row */
    size_t columns;         /* of blocks */
    size_t height;          /* of the map, texels */
} shb_joints;

/* False: out of memory. */
bool shb_joints_create(const shb_context *context, size_t width, size_t height, shb_joints *joints);

/* Nothing is found any more. */
void shb_joints_forget(const shb_joints *joints);

void shb_joints_destroy(const shb_context *context, shb_joints *joints);

size_t shb_joints_bytes(const shb_joints *joints);

#endif
