/* What all measurements share: options, machine, contexts and the printed tables. */
#ifndef BENCH_SESSION_H
#define BENCH_SESSION_H

#include "machine.h"
#include "options.h"
#include "progress.h"
#include "timing.h"

typedef struct bench_session {
    bench_options options;
    bench_machine machine;
    shb_context *context; /* as the options say */
    shb_context *scalar;  /* the reference with as many threads; NULL when the context is scalar */
    shb_context *capped[SHB_ISA_COUNT]; /* of one thread; NULL: the processor lacks it, or the
                                           options do not allow it */
    shb_context *two;                   /* as context, of two threads*/
    bench_clock clock;
    bench_plan plan, scalar_plan;
    progress_line progress;
    char heading[48]; /* the scene whose rows are being printed */
} bench_session;

/* On failure a line has been printed; the session must be closed in any case. */
bool session_open(const bench_options *options, bench_session *session);
void session_close(bench_session *session);

/* The context of one thread with the instruction set of the options. */
shb_context *session_single(const bench_session *session);

/* True if the result is no error; else a line on stderr tells what failed. */
bool session_succeeds(const char *what, shb_result result);

#endif
