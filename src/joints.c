#include "strict.h"

#include "joints.h"

#include <string.h>

static size_t word_bytes(const shb_joints *joints) {
    return joints->height * joints->pitch * sizeof *joints->words;
}

static size_t block_count(const shb_joints *joints) {
    return joints->columns * ((joints->height + SHB_JOINT_ROWS - 1) / SHB_JOINT_ROWS);
}

bool shb_joints_create(const shb_context *context, size_t width, size_t height,
                       shb_joints *joints) {
    joints->columns = (width + SHB_JOINT_COLUMNS - 1) / SHB_JOINT_COLUMNS;
    joints->pitch = joints->columns * (SHB_JOINT_COLUMNS / SHB_JOINT_WORD) + 2 * SHB_JOINT_MARGIN;
    joints->height = height;
    joints->words = shb_alloc(context, word_bytes(joints), 1);
    joints->found = shb_alloc(context, block_count(joints), 1);
    if (!joints->words || !joints->found)
        return false;
    memset((void *)joints->words, 0, word_bytes(joints));
    shb_joints_forget(joints);
    return true;
}

void shb_joints_forget(const shb_joints *joints) {
    memset((void *)joints->found, 0, block_count(joints));
}

void shb_joints_destroy(const shb_context *context, shb_joints *joints) {
    shb_free(context, (void *)joints->words);
    shb_free(context, (void *)joints->found);
}

size_t shb_joints_bytes(const shb_joints *joints) {
    return word_bytes(joints) + block_count(joints);
}
