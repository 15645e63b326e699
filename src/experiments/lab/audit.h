// Convergence audit: obsim's errors in each case as its tolerance shrinks and as its substeps grow. A finer setting
// must give a smaller error: any error above its target that is larger at the finer setting is reported. Below the
// target an error need not fall. If it more than doubles there, and exceeds rounding (a thousandth of the target), it
// is reported separately. Pure; any thread.
#ifndef OB_LAB_AUDIT_H
#define OB_LAB_AUDIT_H

#include "experiment/table.h"
#include "lab/analysis.h"

#define OB_AUDIT_SWEEP "substeps=4,8,16,32,64,128,256,tolerance=10mm,1mm,.1mm,.01mm"
enum { OB_AUDIT_TOLERANCES = 4, OB_AUDIT_SUBSTEPS = 7, OB_AUDIT_SETTINGS = OB_AUDIT_TOLERANCES + OB_AUDIT_SUBSTEPS };

// Figure that is larger at a finer setting; figure < 0: none
typedef struct ob_audit_rise {
	int figure, setting; // the figure; the finer setting
	double times; // ratio to the coarser one; INFINITY: it failed, or the coarser was 0
} ob_audit_rise;

typedef struct ob_audit {
	int measured; // settings
	const ob_result *result[OB_AUDIT_SETTINGS]; // tolerances from coarse to fine, then substeps; NULL: no result
	double ratio[OB_AUDIT_SETTINGS]; // worst figure over its target; INFINITY: failed; NAN: no result
	// Order at which the ratio falls with the length of a substep, above rounding. NAN: it is below 1 and does not
	// change, or has less than two values above rounding.
	double order;
	ob_audit_rise above, below; // the worst rise above a target, and below it
} ob_audit;

ob_audit ob_lab_audit(const ob_lab_analysis *d, const ob_case *c);

// NULL: no case was audited.
ob_table *ob_lab_table_audit(const ob_lab_analysis *d);
// Prints the table and the list of rises, for a terminal or as Markdown; nothing if no case was audited.
void ob_lab_print_audit(FILE *f, const ob_lab_analysis *d, bool markdown);

#endif
