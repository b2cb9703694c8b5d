/* The errors of a frame's latest visibility, as rows have them. */
#ifndef REPORT_JUDGE_H
#define REPORT_JUDGE_H

#include "rows.h"
#include "soft.h"

/* truth: of each fragment, SHB_TRUTH_*. */
shb_result report_judge_hard(const measure_frame *frame, const uint8_t *truth, report_row *row);

/* The answers go to truth->seen. */
shb_result report_judge_soft(const measure_frame *frame, const soft_truth *truth, report_row *row);

#endif
