// The whole test framework: CHECK counts checks; a failed one prints its place and expression. main ends with
// return check_end().
#ifndef OB_TESTS_CHECK_H
#define OB_TESTS_CHECK_H

#include <math.h>
#include <stdio.h>

static int check_done, check_failed;

#define CHECK(what) \
	do { \
		check_done++; \
		if (!(what)) { \
			check_failed++; \
			fprintf(stderr, "%s:%d: failed: %s\n", __FILE__, __LINE__, #what); \
		} \
	} while (0)

// |a - b| <= tolerance; NaN fails
#define CHECK_NEAR(a, b, tolerance) \
	do { \
		double check_a = (a), check_b = (b), check_t = (tolerance); \
		check_done++; \
		if (!(fabs(check_a - check_b) <= check_t)) { \
			check_failed++; \
			fprintf(stderr, "%s:%d: failed: %s = %.17g, expected %.17g within %g\n", __FILE__, __LINE__, \
				#a, check_a, check_b, check_t); \
		} \
	} while (0)

static inline int check_end(void)
{
	printf("%d checks passed, %d failed\n", check_done - check_failed, check_failed);
	return check_failed || !check_done;
}

#endif
