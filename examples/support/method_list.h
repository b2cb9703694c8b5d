/* What is compared: every built-in method, and the exact one by all that a map can keep for it. */
#ifndef EXAMPLES_METHOD_LIST_H
#define EXAMPLES_METHOD_LIST_H

#include "shadowbias/bias.h"

typedef struct listed_method {
    const char *name;
    const shb_bias_method *method;
    shb_occluders occluders; /* that its map keeps */
} listed_method;

/* False behind the last one. */
bool method_list_at(size_t index, listed_method *method);

bool method_list_named(const char *name, listed_method *method);

#endif
