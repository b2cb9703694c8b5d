#include "shadowbias/base.h"

const char *shb_result_string(shb_result result) {
    switch (result) {
    case SHB_OK:
        return "success";
    case SHB_ERROR_ARGUMENT:
        return "a pointer is NULL or a field is out of its range";
    case SHB_ERROR_SIZE:
        return "a size is zero, too large or overflows";
    case SHB_ERROR_NUMBER:
        return "a number is not finite or a matrix cannot be inverted";
    case SHB_ERROR_MEMORY:
        return "out of memory";
    case SHB_ERROR_UNSUPPORTED:
        return "the map or the points lack what the method asks for";
    case SHB_ERROR_FILE:
        return "a file could not be written";
    case SHB_ERROR_ARITHMETIC:
        return "floating point is not IEEE round-to-nearest";
    }
    return "unknown result";
}
