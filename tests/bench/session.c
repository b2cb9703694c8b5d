#include "session.h"

#include "tool.h"

#include <stdio.h>

bool session_succeeds(const char *what, shb_result result) {
    return tool_succeeds("bench", what, result);
}

shb_context *session_single(const bench_session *session) {
    return session->capped[shb_context_isa(session->context)];
}

/* One thread for every instruction set that processor and options allow. */
static bool create_capped(bench_session *session) {
    const shb_isa best = shb_context_isa(session->context);
    for (int isa = SHB_ISA_SCALAR; isa <= (int)best; isa++) {
        shb_context *context = tool_create_context("bench", 1, (shb_isa)isa);
        if (!context)
            return false;
        if (shb_context_isa(context) == (shb_isa)isa)
            session->capped[isa] = context;
        else
            shb_context_destroy(context);
    }
    return true;
}

static bool create_contexts(bench_session *session) {
    const bench_options *options = &session->options;
    session->context = tool_create_context("bench", options->threads, options->isa);
    if (!session->context || !create_capped(session))
        return false;
    if (shb_context_isa(session->context) != SHB_ISA_SCALAR) {
        session->scalar = tool_create_context("bench", options->threads, SHB_ISA_SCALAR);
        if (!session->scalar)
            return false;
    }
    session->two = tool_create_context("bench", 2, options->isa);
    return session->two != NULL;
}

bool session_open(const bench_options *options, bench_session *session) {
    *session =
        (bench_session){.options = *options,
                        .plan = options->quick ? (bench_plan){5, 0.05} : (bench_plan){15, 0.05},
                        .scalar_plan = {options->quick ? 1 : 3, 0}};
    if (!create_contexts(session))
        return false;
    const bool is_single = shb_context_threads(session->context) == 1;
    session->clock = is_single ? BENCH_CLOCK_THREAD : BENCH_CLOCK_WALL;
    /* After the contexts, whose own threads are to stay free. */
    if (options->pin && !machine_pin_thread()) {
        fprintf(stderr, "bench: --pin: the thread cannot be kept on its processor here\n");
        return false;
    }
    if (machine_measure(options->quick ? 4 : 5, &session->machine))
        return true;
    fprintf(stderr, "bench: no memory to measure the machine's bandwidth\n");
    return false;
}

void session_close(bench_session *session) {
    progress_end(&session->progress);
    for (int isa = 0; isa < SHB_ISA_COUNT; isa++)
        shb_context_destroy(session->capped[isa]);
    shb_context_destroy(session->two);
    shb_context_destroy(session->scalar);
    shb_context_destroy(session->context);
}
