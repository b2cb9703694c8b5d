/* Time for measurements. */
#ifndef EXAMPLES_STOPWATCH_H
#define EXAMPLES_STOPWATCH_H

/* Seconds since some moment; never runs backwards. */
double stopwatch_seconds(void);

#endif
