/* Result codes, limits and the conventions that hold everywhere.
 *
 * World space is right-handed. Matrices are column-major and act on column vectors. Clip depth runs
 * from 0 at the near plane to 1 at the far plane (1 to 0 when reversed). Row 0 of an image or a map
 * is the top row, which is where clip y is +w; texel (i, j) is column i of row j and its centre
 * lies at (i + 0.5, j + 0.5). A front face is counter-clockwise as the camera sees it.
 *
 * In a zero-initialised description every field has the meaning that its comment gives to 0; fields
 * without one must be set. A function that fails leaves its outputs untouched. Functions are
 * thread-safe unless their comment says otherwise. */
#ifndef SHADOWBIAS_BASE_H
#define SHADOWBIAS_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SHB_VERSION_MAJOR 0
#define SHB_VERSION_MINOR 1
#define SHB_VERSION_PATCH 0

/* The largest width and height of a map or a camera target, in texels. */
#define SHB_SIZE_MAX 16384

/* The largest number of triangles in a scene; ids are 0 .. count - 1. */
#define SHB_TRIANGLES_MAX 0x7fffffffu

/* The id of a sample that no triangle covers. */
#define SHB_ID_NONE 0xffffffffu

/* Fragments pass through the library in batches of at most this many. */
#define SHB_BATCH 256

/* Batch arrays start on cache lines. */
#ifdef __cplusplus
#define SHB_ALIGN alignas(64)
#else
#define SHB_ALIGN _Alignas(64)
#endif

/* The most parameters of a bias method or filter. */
#define SHB_PARAMS_MAX 8

typedef enum shb_result {
    SHB_OK = 0,
    SHB_ERROR_ARGUMENT,    /* a pointer is NULL, or an enumerator or field is out of range */
    SHB_ERROR_SIZE,        /* a size is zero, above its limit, or a product of sizes overflows */
    SHB_ERROR_NUMBER,      /* a number that must be finite is not, or a matrix cannot be inverted */
    SHB_ERROR_MEMORY,      /* the allocator returned NULL, or a description allows too little */
    SHB_ERROR_UNSUPPORTED, /* the map or the points lack what the method asks for */
    SHB_ERROR_FILE,        /* a file could not be written */
    SHB_ERROR_ARITHMETIC   /* this build or thread does not keep IEEE round-to-nearest arithmetic */
} shb_result;

/* A short sentence for the code, never NULL; an unknown code gives "unknown result". */
const char *shb_result_string(shb_result result);

#ifdef __cplusplus
}
#endif

#endif
