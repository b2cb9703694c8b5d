/* The text form of methods and filters: "name" or "name:param=value,param=value". */
#ifndef SRC_METHOD_TEXT_H
#define SRC_METHOD_TEXT_H

#include "shadowbias/base.h"

/* What sentences call a method or filter: a host's own may have no name. */
const char *shb_method_name(const char *name);

/* True if the text's name part is name. */
bool shb_text_has_name(const char *text, const char *name);

/* Reads the text's parameters into params, in the order of names; those that the text leaves out
 * keep their value, a repeated one keeps its last. False when the text is malformed, names an
 * unknown parameter or has a number that is not a finite float; params may have changed then. */
bool shb_text_read_params(const char *text, const char *const names[SHB_PARAMS_MAX],
                          float params[SHB_PARAMS_MAX]);

#endif
