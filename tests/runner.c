// Runs one test of a module: "step_tests pairs" calls main of step/test_pairs.c with what follows. The build makes the table
// TESTS and renames each main to main_of_TOPIC.
#include <stdio.h>
#include <string.h>

#define DECLARE(topic) int main_of_##topic(int argc, char **argv);
TESTS(DECLARE)

static const struct {
	const char *topic;
	int (*run)(int argc, char **argv);
} tests[] = {
#define ENTRY(topic) { #topic, main_of_##topic },
	TESTS(ENTRY)
};

int main(int argc, char **argv)
{
	const size_t n = sizeof tests / sizeof *tests;
	for (size_t i = 0; argc > 1 && i < n; i++)
		if (!strcmp(argv[1], tests[i].topic))
			return tests[i].run(argc - 1, argv + 1);
	fprintf(stderr, "usage: %s TOPIC [ARGUMENT ..], one of:\n", argv[0]);
	for (size_t i = 0; i < n; i++)
		fprintf(stderr, "  %s\n", tests[i].topic);
	return 2;
}
