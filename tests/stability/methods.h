/* What is compared: every built-in method, and the exact one by all that a map can keep for it. */
#ifndef STABILITY_METHODS_H
#define STABILITY_METHODS_H

#include "shadowbias/bias.h"

typedef struct stability_method {
    const char *name;
    const shb_bias_method *method;
    shb_occluders occluders; /* that its map keeps */
} stability_method;

/* False behind the last one. */
bool stability_method_at(size_t index, stability_method *method);

bool stability_method_named(const char *name, stability_method *method);

#endif
