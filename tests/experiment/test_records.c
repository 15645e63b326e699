// Records: their file, and their analysis.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "check.h"
#include "experiment/analysis.h"

static const ob_metric metrics[] = {
	{ .key = "time_s", .title = "time", .unit = "ms", .scale = 1e3, .target = NAN },
	{ .key = "error_m", .title = "error", .unit = "mm", .scale = 1e3, .target = 1 },
};
static const char *const columns[] = { "doubled" };

static void describe(const ob_record *r, size_t column, char *to, size_t room)
{
	snprintf(to, room, "%s, %s", r->of, r->of);
}

static const ob_experiment x = { .name = "test",
				 .commit = "c0ffee",
				 .metrics = 2,
				 .metric = metrics,
				 .columns = 1,
				 .column = columns,
				 .describe = describe };

static void add(ob_records *r, const char *of, const char *configuration, uint32_t repeat, double time, double error)
{
	ob_record one = { .repeat = repeat, .took_s = 1. / 3, .took_cpu_s = 1e-9 / 7, .metric = { time, error } };
	snprintf(one.of, sizeof one.of, "%s", of);
	snprintf(one.configuration, sizeof one.configuration, "%s", configuration);
	strcpy(one.machine, "A processor, \"fast\", 2 cores");
	strcpy(one.commit, "c0ffee");
	CHECK(ob_records_add(r, &one));
}

static void fill(ob_records *r)
{
	add(r, "pile", "8 substeps", 0, 1. / 3, 1e-300);
	add(r, "stack, 40 high", "1", 0, 1e-9 / 7, INFINITY);
	add(r, "stack, 40 high", "1", 1, NAN, NAN);
	ob_record *odd = &r->record[2];
	odd->failure = OB_FAILURE_CRASH;
	odd->seed = UINT64_MAX;
	strcpy(odd->note, "0123456789abcdef");
	strcpy(odd->reason, "crashed: \"a, b\" and more");
}

static bool same(const ob_record *a, const ob_record *b)
{
	bool same = !strcmp(a->of, b->of) && !strcmp(a->configuration, b->configuration) && a->repeat == b->repeat &&
		    a->seed == b->seed && a->failure == b->failure && !strcmp(a->reason, b->reason) &&
		    !strcmp(a->note, b->note) && a->took_s == b->took_s && a->took_cpu_s == b->took_cpu_s &&
		    !strcmp(a->machine, b->machine) && !strcmp(a->commit, b->commit);
	for (size_t i = 0; i < x.metrics; i++)
		same &= a->metric[i] == b->metric[i] || (isnan(a->metric[i]) && isnan(b->metric[i]));
	return same;
}

static char *read_all(const char *path)
{
	FILE *f = fopen(path, "r");
	char *text = NULL;
	size_t room = 0;
	ssize_t n = f ? getdelim(&text, &room, 0, f) : -1;
	CHECK(n > 0);
	if (f)
		fclose(f);
	return text;
}

static void test_file(const char *path)
{
	ob_records out = { 0 }, in = { 0 };
	ob_error e;
	CHECK(ob_records_read(&in, &x, path, &e) && in.count == 0); // a missing file
	fill(&out);
	CHECK(ob_records_write(&out, &x, path, &e) && ob_records_read(&in, &x, path, &e));
	CHECK(in.count == out.count);
	for (size_t i = 0; i < in.count && i < out.count; i++)
		CHECK(same(&in.record[i], &out.record[i]));
	char *first = read_all(path);
	CHECK(ob_records_write(&in, &x, path, &e));
	char *second = read_all(path);
	CHECK(first && second && strcmp(first, second) == 0);
	CHECK(first &&
	      strstr(first,
		     "\ntest,\"stack, 40 high\",1,1,18446744073709551615,\"stack, 40 high, stack, 40 high\",,,"));
	CHECK(first && strstr(first, "\"crashed: \"\"a, b\"\" and more\""));
	free(first);
	free(second);
	ob_records_finish(&in);
	ob_records_finish(&out);
}

static void write_text(const char *path, const char *text, size_t n)
{
	FILE *f = fopen(path, "w");
	CHECK(f && fwrite(text, 1, n, f) == n);
	if (f)
		fclose(f);
}

static void refuse(const char *path, const char *text, const char *saying)
{
	ob_records r = { 0 };
	ob_error e = { "" };
	write_text(path, text, strlen(text));
	CHECK(!ob_records_read(&r, &x, path, &e));
	CHECK(r.count == 0 && !r.record);
	if (!strstr(e.text, saying))
		fprintf(stderr, "said '%s' instead of '%s'\n", e.text, saying);
	CHECK(strstr(e.text, saying));
}

// Replaces a text in the file; reading must fail.
static void refuse_changed(const char *path, const char *whole, const char *old, const char *new, const char *saying)
{
	const char *at = strstr(whole, old);
	char *changed = NULL;
	CHECK(at);
	if (at && asprintf(&changed, "%.*s%s%s", (int)(at - whole), whole, new, at + strlen(old)) > 0)
		refuse(path, changed, saying);
	free(changed);
}

// A failed write leaves the old file as it is, and nothing beside it.
static void test_full_disk(const char *path, const ob_records *r, const char *whole)
{
	char beside[80];
	ob_error e = { "" };
	snprintf(beside, sizeof beside, "%s.new", path);
	CHECK(ob_records_write(r, &x, path, &e));
	CHECK(symlink("/dev/full", beside) == 0);
	CHECK(!ob_records_write(r, &x, path, &e) && strstr(e.text, "No space left"));
	CHECK(access(beside, F_OK) != 0);
	char *after = read_all(path);
	CHECK(whole && after && strcmp(whole, after) == 0);
	free(after);
}

static void test_broken_file(const char *path)
{
	ob_records out = { 0 };
	ob_error e;
	fill(&out);
	CHECK(ob_records_write(&out, &x, path, &e));
	char *whole = read_all(path);
	refuse(path, "", "is empty");
	refuse(path, "a,b", "no head");
	refuse(path, "a,b\n", "no column 'experiment'");
	refuse(path, "\"a\"b,\n", "not CSV");
	if (whole) {
		refuse_changed(path, whole, "time_s", "time", "no column 'time_s'");
		refuse_changed(path, whole, "\ntest,", "\npaper,", "of 'paper', not of 'test'");
		refuse_changed(path, whole, "e-300", "e-300x", ":2: error_m");
		refuse_changed(path, whole, ",crash,", ",bored,", "no failure 'bored'");
		size_t n = strlen(whole);
		for (size_t cut = 1; cut < n; cut++) { // a truncated line is ignored
			ob_records r = { 0 };
			write_text(path, whole, n - cut);
			if (ob_records_read(&r, &x, path, &e))
				CHECK(r.count < out.count && (r.count == 0 || same(&r.record[0], &out.record[0])));
			ob_records_finish(&r);
		}
	}
	CHECK(!ob_records_write(&out, &x, "/no/such/folder/results.csv", &e) && strstr(e.text, "/no/such/folder"));
	test_full_disk(path, &out, whole);
	free(whole);
	ob_records_finish(&out);
}

static void test_statistics(void)
{
	ob_records r = { 0 };
	for (uint32_t i = 0; i < 7; i++) {
		add(&r, "pile", "a", i, i + 1, i);
		add(&r, "pile", "b", i, 2 * (i + 1), 1);
	}
	ob_statistics s = ob_records_summarise(&r, "pile", "a", 0);
	CHECK(s.n == 7 && s.median == 4 && s.median_low == 1 && s.median_high == 7);
	s = ob_records_ratio(&r, "pile", "b", "a", 0, false);
	CHECK(s.n == 7 && s.least == 2 && s.most == 2);
	s = ob_records_ratio(&r, "pile", "b", "a", 0, true);
	CHECK_NEAR(exp(s.mean), 2, 1e-12);
	r.record[0].failure = OB_FAILURE_CRASH;
	const ob_record *failed;
	CHECK(ob_records_ratio(&r, "pile", "b", "a", 0, false).n == 6);
	CHECK(ob_records_have(&r, "pile", "a", &failed) && failed == &r.record[0]);
	CHECK(ob_records_have(&r, "pile", "b", &failed) && !failed && !ob_records_have(&r, "heap", "b", NULL));
	CHECK(isnan(ob_records_summarise(&r, "heap", "a", 0).median));
	ob_records_finish(&r);
}

static double at(size_t count, double error)
{
	ob_cost_point p[] = { { 1e-3, 1e-1 }, { 1e-1, 1e-5 }, { 2e-2, 2e-1 }, { 1e-2, 1e-4 }, { 1, 0 } };
	return ob_cost_at_error(p, count, error);
}

static void test_equal_error(void)
{
	CHECK(isnan(at(0, 1)));
	CHECK_NEAR(at(2, 1), 1e-3, 1e-15); // no cheaper than the cheapest
	CHECK_NEAR(at(2, 1e-1), 1e-3, 1e-15);
	CHECK_NEAR(at(2, 1e-3), 1e-2, 1e-14); // half-way in the logarithms
	CHECK_NEAR(at(2, 1e-4), pow(10, -1.5), 1e-13);
	CHECK(isnan(at(2, .9e-5))); // nothing beyond the last
	CHECK_NEAR(at(3, 1e-3), 1e-2, 1e-14); // worse in both than the first: not on the envelope
	CHECK_NEAR(at(4, 1e-4), 1e-2, 1e-14); // better than the line
	CHECK_NEAR(at(4, 1e-2), pow(10, -3 + 1. / 3), 1e-13);
	CHECK_NEAR(at(5, 1e-8), 1, 0); // exact: a step down, not a line
	CHECK_NEAR(at(5, 0), 1, 0);
}

int main(void)
{
	char folder[] = "/tmp/obsim-test-XXXXXX", path[64];
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/results.csv", folder);
	test_file(path);
	test_broken_file(path);
	test_statistics();
	test_equal_error();
	unlink(path);
	CHECK(rmdir(folder) == 0); // nothing else is left there
	return check_end();
}
