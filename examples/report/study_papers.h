/* The papers' own tables and figures, with our ratios beside theirs. */
#ifndef REPORT_STUDY_PAPERS_H
#define REPORT_STUDY_PAPERS_H

#include "study.h"

extern const report_study report_study_papers;

#endif
