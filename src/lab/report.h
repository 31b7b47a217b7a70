/* lab: report.md and all that it links to. */
#ifndef NOC_LAB_REPORT_H
#define NOC_LAB_REPORT_H

#include "lab/session.h"

noc_status lab_write_report(const lab_session *lab); /* needs lab_session.values */

#endif
