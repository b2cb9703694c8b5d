/* What the machine is called. */
#ifndef REPORT_MACHINE_NAME_H
#define REPORT_MACHINE_NAME_H

#include <stddef.h>

/* The processor's name as the system tells it, without characters that HTML reads as its own; "an
 * unknown processor" if it tells none. */
void report_machine_name(char *name, size_t size);

#endif
