/* The instruction sets of this machine, each of them once: a cap that it lacks would only repeat
 * the next lower one. */
#ifndef TESTS_SUPPORT_ISAS_H
#define TESTS_SUPPORT_ISAS_H

#include "../../src/context.h"

/* The next one, or SHB_ISA_COUNT. SHB_ISA_SCALAR is the first. */
static inline shb_isa test_isa_after(shb_isa isa) {
    do
        isa = (shb_isa)(isa + 1);
    while (isa < SHB_ISA_COUNT && shb_cpu_isa(isa) != isa);
    return isa;
}

#endif
