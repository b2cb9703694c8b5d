/* Which setting is to blame: causes of wrong fragments, with pictures, for the main scenes. */
#ifndef REPORT_STUDY_CAUSES_H
#define REPORT_STUDY_CAUSES_H

#include "study.h"

extern const report_study report_study_causes;

#endif
