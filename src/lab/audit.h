// The audit of convergence: obsim's errors in each case as its tolerance shrinks and as its substeps grow. What is
// asked for more closely must come out more closely: an error that is larger at the finer setting is named, wherever it
// is above its target. Below its target an error need not fall; where it rises there by more than twice, and is not as
// small as rounding (a thousandth of the target), it is named apart. Pure; any thread.
#ifndef OB_LAB_AUDIT_H
#define OB_LAB_AUDIT_H

#include "experiment/table.h"
#include "lab/analysis.h"

#define OB_AUDIT_SWEEP "substeps=4,8,16,32,64,128,256,tolerance=10mm,1mm,.1mm,.01mm"
enum { OB_AUDIT_TOLERANCES = 4, OB_AUDIT_SUBSTEPS = 7, OB_AUDIT_SETTINGS = OB_AUDIT_TOLERANCES + OB_AUDIT_SUBSTEPS };

// A figure that is larger at a finer setting; figure < 0: there is none
typedef struct ob_audit_rise {
	int figure, setting; // the finer one
	double times; // over the coarser one; INFINITY: it failed, or the coarser was 0
} ob_audit_rise;

typedef struct ob_audit {
	int measured; // settings
	const ob_result *result[OB_AUDIT_SETTINGS]; // tolerances from coarse to fine, then substeps; NULL: no result
	double ratio[OB_AUDIT_SETTINGS]; // worst figure over its target; INFINITY: failed; NAN: no result
	// At which the ratio falls with the length of a substep, above rounding. NAN: it is below 1 and does not
	// change, or has less than two values above rounding.
	double order;
	ob_audit_rise above, below; // the worst rise above a target, and below it
} ob_audit;

ob_audit ob_lab_audit(const ob_lab_analysis *d, const ob_case *c);

// NULL: nothing was audited
ob_table *ob_lab_table_audit(const ob_lab_analysis *d);
// With the list of what rises, for a terminal or as Markdown; nothing where nothing was audited
void ob_lab_print_audit(FILE *f, const ob_lab_analysis *d, bool markdown);

#endif
