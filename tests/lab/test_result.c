// Results: their order, their file, what is read off them.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "check.h"
#include "lab/result.h"

static ob_result make(const char *name, const char *engine, uint32_t substeps, double cost, double error)
{
	ob_result r = { .of = ob_case_find(name), .engine = ob_engine_find(engine), .commit = "c0ffee" };
	r.settings = r.engine->usual;
	r.settings.substeps = substeps;
	r.settings.tolerance = 0;
	ob_outcome o = { .cpu_s = cost, .wall_s = 2 * cost, .body_seconds = 1 };
	for (uint32_t i = 0; i < r.of->figures; i++)
		o.figure[i] = error;
	ob_result_repeat(&r, &o);
	return r;
}

static void add(ob_results *to, ob_result r)
{
	CHECK(ob_results_add(to, &r));
}

static void test_order(void)
{
	ob_results r = { 0 };
	add(&r, make("pile", "obsim", 8, 1, 1));
	add(&r, make("stack-10", "ode-quick", 1, 1, 1));
	add(&r, make("stack-10", "obsim", 16, 1, 1));
	ob_result one = make("stack-10", "obsim", 0, 1, 1);
	one.settings.tolerance = 1e-4;
	add(&r, one);
	one.settings.tolerance = 1e-3;
	add(&r, one);
	add(&r, make("stack-10", "obsim", 2, 1, 1));
	static const uint32_t substeps[] = { 2, 16, 0, 0, 1, 8 };
	CHECK(r.count == 6);
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].settings.substeps == substeps[i]);
	CHECK(r.result[2].settings.tolerance == 1e-3 && r.result[3].settings.tolerance == 1e-4);
	CHECK(strcmp(r.result[4].engine->name, "ode-quick") == 0);
	CHECK(strcmp(r.result[5].of->name, "pile") == 0);
	CHECK(ob_results_find(&r, one.of, one.engine, &one.settings) == &r.result[2]);
	one.settings.lag++;
	CHECK(!ob_results_find(&r, one.of, one.engine, &one.settings));
	ob_results_finish(&r);
	CHECK(r.count == 0 && !r.result);
}

static void test_repeats(void)
{
	ob_result r = make("pile", "obsim", 8, 3, .5);
	ob_outcome again = r.outcome;
	again.cpu_s = 1;
	again.wall_s = 9;
	again.figure[1] = .7;
	ob_result_repeat(&r, &again);
	CHECK(r.repeats == 2 && r.outcome.cpu_s == 2 && r.outcome.wall_s == 7.5);
	again.cpu_s = 1.5;
	again.figure[1] = .1;
	ob_result_repeat(&r, &again);
	CHECK(r.outcome.cpu_s == 1.5 && r.outcome.figure[0] == .5 && r.outcome.figure[1] == .7 && !*r.outcome.failed);
	strcpy(again.failed, "fell");
	ob_result_repeat(&r, &again);
	CHECK(strcmp(r.outcome.failed, "fell") == 0);
	for (int i = 0; i < 2 * OB_REPEATS; i++)
		ob_result_repeat(&r, &again);
	CHECK(r.repeats == OB_REPEATS && r.outcome.cpu_s == 1.5);
}

static bool same(const ob_result *a, const ob_result *b)
{
	bool same = a->of == b->of && a->engine == b->engine && a->repeats == b->repeats &&
		    !memcmp(&a->settings, &b->settings, sizeof a->settings) && !strcmp(a->commit, b->commit) &&
		    !strcmp(a->outcome.failed, b->outcome.failed) && a->outcome.cpu_s == b->outcome.cpu_s &&
		    a->outcome.wall_s == b->outcome.wall_s;
	for (uint32_t i = 0; i < a->repeats; i++)
		same &= a->cpu_s[i] == b->cpu_s[i] && a->wall_s[i] == b->wall_s[i];
	for (uint32_t i = 0; i < a->of->figures; i++)
		same &= a->outcome.figure[i] == b->outcome.figure[i] ||
			(isnan(a->outcome.figure[i]) && isnan(b->outcome.figure[i]));
	return same && (a->outcome.body_seconds == b->outcome.body_seconds ||
			(isnan(a->outcome.body_seconds) && isnan(b->outcome.body_seconds)));
}

static void fill(ob_results *r)
{
	add(r, make("pile", "obsim", 8, 1. / 3, 1e-300));
	add(r, make("stack-40", "ode-world", 1, 1e-9 / 7, INFINITY));
	ob_result odd = make("stack-10", "obsim-jacobi", 0, .1, NAN);
	odd.settings.tolerance = 5e-4 / 3;
	odd.settings.sleeping = true;
	odd.outcome.body_seconds = NAN;
	strcpy(odd.outcome.failed, "crashed: \"a, b\"\r\nand more");
	ob_result_repeat(&odd, &odd.outcome);
	add(r, odd);
	strcpy(r->machine, "A processor, \"fast\", 2 cores");
	strcpy(r->commit, "c0ffee");
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
	ob_results out = { 0 }, in = { 0 };
	ob_error e;
	CHECK(ob_results_read(&in, path, &e) && in.count == 0); // there is none
	fill(&out);
	CHECK(ob_results_write(&out, path, &e));
	CHECK(ob_results_read(&in, path, &e));
	CHECK(in.count == out.count && !strcmp(in.machine, out.machine) && !strcmp(in.commit, out.commit));
	for (size_t i = 0; i < in.count && i < out.count; i++)
		CHECK(same(&in.result[i], &out.result[i]));
	char *first = read_all(path), *second;
	CHECK(ob_results_write(&in, path, &e));
	second = read_all(path);
	CHECK(first && second && strcmp(first, second) == 0);
	// a line for each result and one for the names, of as many cells
	CHECK(first && strstr(first, "\r\nstack-10,14,obsim-jacobi,,"));
	CHECK(first && strstr(first, "\"crashed: \"\"a, b\"\"\r\nand more\""));
	free(first);
	free(second);
	ob_results_finish(&in);
	ob_results_finish(&out);
}

static void write_text(const char *path, const char *text, size_t n)
{
	FILE *f = fopen(path, "w");
	CHECK(f && fwrite(text, 1, n, f) == n);
	if (f)
		fclose(f);
}

static void refuse(const char *path, const char *text, size_t n, const char *saying)
{
	ob_results r;
	ob_error e = { "" };
	write_text(path, text, n);
	CHECK(!ob_results_read(&r, path, &e));
	CHECK(r.count == 0 && !r.result);
	if (!strstr(e.text, saying)) {
		fprintf(stderr, "said '%s' instead of '%s'\n", e.text, saying);
		CHECK(!"the right words");
	}
}

// The file with some text replaced by another, which has to be refused
static void refuse_changed(const char *path, const char *whole, const char *old, const char *new, const char *saying)
{
	const char *at = strstr(whole, old);
	char *changed = NULL;
	CHECK(at);
	if (at && asprintf(&changed, "%.*s%s%s", (int)(at - whole), whole, new, at + strlen(old)) > 0)
		refuse(path, changed, strlen(changed), saying);
	free(changed);
}

// What cannot be written whole leaves the old file as it is, and nothing beside it.
static void test_full_disk(const char *path, const ob_results *r, const char *whole)
{
	char beside[80];
	ob_error e = { "" };
	snprintf(beside, sizeof beside, "%s.new", path);
	CHECK(ob_results_write(r, path, &e));
	CHECK(symlink("/dev/full", beside) == 0);
	CHECK(!ob_results_write(r, path, &e) && strstr(e.text, "No space left"));
	CHECK(access(beside, F_OK) != 0);
	char *after = read_all(path);
	CHECK(whole && after && strcmp(whole, after) == 0);
	free(after);
}

static void test_broken_file(const char *path)
{
	ob_results out = { 0 };
	ob_error e;
	fill(&out);
	CHECK(ob_results_write(&out, path, &e));
	char *whole = read_all(path);
	refuse(path, "", 0, "is empty");
	refuse(path, "a,b\n", 4, "2 cells");
	refuse(path, "\"a", 2, "not CSV");
	refuse(path, "\"a\"b,", 5, "not CSV");
	if (whole) {
		refuse_changed(path, whole, "substeps", "substep", "column 'substep' instead of 'substeps'");
		refuse_changed(path, whole, "\r\npile,", "\r\npillow,", "no case 'pillow'");
		refuse_changed(path, whole, ",ode-world,", ",physx,", "no engine 'physx'");
		refuse_changed(path, whole, "e-300", "e-300x", ":4: figure1_value");
		refuse_changed(path, whole, ",0.016666666666666666,", ",often,", "'often' is not a number");
		size_t n = strlen(whole);
		for (size_t cut = 1; cut < n; cut += 37) {
			ob_results r = { 0 };
			write_text(path, whole, n - cut);
			if (ob_results_read(&r, path, &e)) // cut between two lines, or in the last cell
				CHECK(r.count <= out.count);
			ob_results_finish(&r);
		}
	}
	CHECK(!ob_results_write(&out, "/no/such/folder/results.csv", &e) && strstr(e.text, "/no/such/folder"));
	test_full_disk(path, &out, whole);
	free(whole);
	ob_results_finish(&out);
}

static double at(const ob_results *r, double error)
{
	return ob_cost_at(r, ob_case_find("pile"), ob_engine_find("obsim"), error);
}

static void test_equal(void)
{
	ob_results r = { 0 };
	CHECK(isnan(at(&r, 1)));
	add(&r, make("pile", "ode-quick", 1, 1e-6, 1e-6)); // others' points do not count
	add(&r, make("stack-10", "obsim", 1, 1e-6, 1e-6));
	CHECK(isnan(at(&r, 1)));
	add(&r, make("pile", "obsim", 1, 1e-3, 1e-1));
	add(&r, make("pile", "obsim", 4, 1e-1, 1e-5));
	CHECK_NEAR(at(&r, 1), 1e-3, 1e-15); // no cheaper than the cheapest
	CHECK_NEAR(at(&r, 1e-1), 1e-3, 1e-15);
	CHECK_NEAR(at(&r, 1e-3), 1e-2, 1e-14); // half-way in the logarithms
	CHECK_NEAR(at(&r, 1e-4), pow(10, -1.5), 1e-13);
	CHECK_NEAR(at(&r, 1e-5), 1e-1, 1e-13);
	CHECK(isnan(at(&r, .9e-5))); // nothing beyond the last
	add(&r, make("pile", "obsim", 2, 2e-2, 2e-1)); // worse in both than the first: not on the envelope
	CHECK_NEAR(at(&r, 1e-3), 1e-2, 1e-14);
	add(&r, make("pile", "obsim", 3, 1e-2, 1e-4)); // better than the line
	CHECK_NEAR(at(&r, 1e-4), 1e-2, 1e-14);
	CHECK_NEAR(at(&r, 1e-2), pow(10, -3 + 1. / 3), 1e-13);
	ob_result failed = make("pile", "obsim", 5, 1e-5, 1e-9);
	strcpy(failed.outcome.failed, "fell");
	add(&r, failed);
	add(&r, make("pile", "obsim", 6, 1e-5, NAN));
	CHECK_NEAR(at(&r, 1e-4), 1e-2, 1e-14);
	CHECK(isnan(at(&r, 1e-8)));
	add(&r, make("pile", "obsim", 7, 1, 0)); // exact: a step down, not a line
	CHECK_NEAR(at(&r, 1e-8), 1, 0);
	CHECK_NEAR(at(&r, 0), 1, 0);
	CHECK_NEAR(at(&r, 1e-5), 1e-1, 1e-13);
	ob_results_finish(&r);
}

int main(void)
{
	char folder[] = "/tmp/obsim-test-XXXXXX", path[64];
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/results.csv", folder);
	test_order();
	test_repeats();
	test_file(path);
	test_broken_file(path);
	test_equal();
	unlink(path);
	CHECK(rmdir(folder) == 0); // nothing else is left there
	return check_end();
}
