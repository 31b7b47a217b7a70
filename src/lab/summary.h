/* lab: summary.md. */
#ifndef NOC_LAB_SUMMARY_H
#define NOC_LAB_SUMMARY_H

#include "lab/session.h"

noc_status lab_write_summary(const lab_session *lab);

#endif
