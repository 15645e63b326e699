// obsim compare: one scene, run in five ways, each in a fresh process of its own so that none warms another's
// caches or memory. Time is taken undisturbed; what has to be measured at each step comes from a run of its own, once
// for the monolith and once for the object simulators, whose states are the same however they are run.
#include "cli/compare.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/child.h"
#include "cli/command.h"
#include "cli/request.h"

const ob_variant ob_variant_table[OB_VARIANTS] = {
	{ "monolith", "monolith", "monolith", "thread", false, 0 },
	{ "threads", "threads", "obs", "thread", false, 0 },
	{ "processes", "processes", "obs", "process", false, 0 },
	// more than these make one workstation wait for its scheduler alone
	{ "threads_each", "thread each", "obs", "thread", true, 4096 },
	{ "processes_each", "process each", "obs", "process", true, 1024 },
};
enum { RUNS = OB_VARIANTS + 2, ARGUMENTS_MAX = 2 * OB_OPTIONS + 16 };

typedef struct plan {
	const ob_arguments *arguments;
	uint32_t workers; // of the pool
	int runs; // done or begun, of RUNS
} plan;

static bool is_monolith(const ob_variant *v)
{
	return strcmp(v->arch, "monolith") == 0;
}

// Options that a child of this kind understands and that are not compare's own
static bool passes_on(const ob_variant *v, int id)
{
	if (!(ob_option_table[id].commands & OB_COMMAND_COMPARE) || !ob_option_table[id].argument)
		return false;
	switch (id) {
	case OB_OPTION_DEFINE:
	case OB_OPTION_WORKERS:
	case OB_OPTION_JSON:
		return false;
	case OB_OPTION_TOLERANCE:
	case OB_OPTION_PASSES:
	case OB_OPTION_EXCHANGE:
	case OB_OPTION_LAG:
	case OB_OPTION_INTEGRATOR:
		return !is_monolith(v);
	case OB_OPTION_ITERATIONS:
		return is_monolith(v);
	default:
		return true;
	}
}

// The child's command line, each string and the array malloc'd; NULL when memory is out
static char **make_arguments(const plan *p, const ob_variant *v, const char *measure)
{
	const ob_arguments *a = p->arguments;
	char **argv = calloc(ARGUMENTS_MAX + a->defines, sizeof *argv);
	size_t n = 0;
	bool fine = argv != NULL;
#define ADD(...) (fine = fine && asprintf(&argv[n++], __VA_ARGS__) >= 0)
	ADD("obsim");
	ADD("run");
	ADD("--json=-");
	ADD("--arch=%s", v->arch);
	ADD("--isolation=%s", v->isolation);
	ADD("--measure=%s", measure);
	if (v->each)
		ADD("--workers=objects");
	else if (!is_monolith(v))
		ADD("--workers=%" PRIu32, p->workers);
	for (int i = 0; i < OB_OPTIONS; i++) {
		if (passes_on(v, i) && a->value[i])
			ADD("--%s=%s", ob_option_table[i].name, a->value[i]);
	}
	for (uint32_t i = 0; i < a->defines; i++)
		ADD("-D%s", a->define[i]);
	ADD("--");
	ADD("%s", a->operand);
#undef ADD
	return argv;
}

static void free_arguments(char **argv)
{
	for (char **at = argv; at && *at; at++)
		free(*at);
	free(argv);
}

static void announce(plan *p, const ob_variant *v)
{
	p->runs++;
	if (isatty(STDERR_FILENO))
		fprintf(stderr, "\r\033[K%d of %d: %s", p->runs, RUNS, v->title);
}

static void run_variant(plan *p, const ob_variant *v, const char *measure, ob_variant_result *out)
{
	ob_child_result child = { 0 };
	ob_error e;
	announce(p, v);
	char **argv = make_arguments(p, v, measure);
	bool started = argv && ob_child_run(argv, &child, &e);
	if (!argv)
		ob_fail(&e, "out of memory");
	out->state = OB_VARIANT_FAILED;
	if (!started)
		snprintf(out->why, sizeof out->why, "%.250s", e.text);
	else if (child.code != 0)
		snprintf(out->why, sizeof out->why, "%.250s",
			 *child.complaint ? child.complaint : "it died without a word");
	else if (!ob_report_read_json(&out->report, child.out))
		snprintf(out->why, sizeof out->why, "its report cannot be read");
	else
		out->state = OB_VARIANT_DONE;
	ob_child_finish(&child);
	free_arguments(argv);
}

// What was measured along a run like this one; false if it did not end like this one
static bool complete(ob_report *to, const ob_report *from)
{
	if (strcmp(to->state_hash, from->state_hash) != 0)
		return false;
	to->energy_gain_max = from->energy_gain_max;
	to->momentum_error = from->momentum_error;
	to->worst_penetration_m = from->worst_penetration_m;
	to->worst_penetration_time_s = from->worst_penetration_time_s;
	return true;
}

static void measure_kind(plan *p, ob_comparison *c, int first, int last)
{
	ob_variant_result *measured = calloc(1, sizeof *measured);
	if (!measured || ob_child_interrupted()) {
		free(measured);
		return;
	}
	run_variant(p, &ob_variant_table[first], "step", measured);
	if (measured->state == OB_VARIANT_FAILED)
		c->result[first] = *measured;
	for (int i = first; measured->state == OB_VARIANT_DONE && i <= last; i++) {
		if (c->result[i].state == OB_VARIANT_DONE && !complete(&c->result[i].report, &measured->report))
			c->measured_differs |= first > 0;
	}
	free(measured);
}

static void run_all(plan *p, ob_comparison *c, uint32_t objects)
{
	for (int i = 0; i < OB_VARIANTS && !ob_child_interrupted(); i++) {
		const ob_variant *v = &ob_variant_table[i];
		ob_variant_result *r = &c->result[i];
		if (v->each && objects > v->objects_max)
			snprintf(r->why, sizeof r->why,
				 "%" PRIu32 " objects are more than the %" PRIu32 " that are tried", objects,
				 v->objects_max);
		else
			run_variant(p, v, "end", r);
	}
	if (c->result[0].state == OB_VARIANT_DONE)
		measure_kind(p, c, 0, 0);
	if (c->result[1].state == OB_VARIANT_DONE)
		measure_kind(p, c, 1, OB_VARIANTS - 1);
	if (isatty(STDERR_FILENO))
		fputs("\r\033[K", stderr);
}

static int tell(const ob_comparison *c, const char *json)
{
	bool json_out = json && strcmp(json, "-") == 0;
	ob_comparison_print(c, json_out ? stderr : stdout);
	ob_error e;
	if (json) {
		FILE *f = json_out ? stdout : fopen(json, "we");
		if (f)
			ob_comparison_write_json(c, f);
		if (!f || fflush(f) != 0 || ferror(f) || (!json_out && fclose(f) != 0)) {
			ob_fail(&e, "--json %s: %s", json, strerror(errno));
			return ob_command_fail(OB_EXIT_FAILED, e.text);
		}
	}
	const char *hash;
	if (!ob_comparison_agrees(c, &hash))
		return ob_command_fail(OB_EXIT_FAILED, "the object simulators did not end in the same state");
	for (int i = 0; i < OB_VARIANTS; i++) {
		if (c->result[i].state == OB_VARIANT_FAILED) {
			ob_fail(&e, "%s: %s", ob_variant_table[i].title, c->result[i].why);
			return ob_command_fail(OB_EXIT_FAILED, e.text);
		}
	}
	return OB_EXIT_OK;
}

int ob_command_compare(const ob_arguments *a)
{
	ob_run_request request;
	ob_run_settings settings;
	ob_error e;
	if (!ob_request_read(&request, a, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	if (request.workers == 0)
		return ob_command_fail(OB_EXIT_USAGE,
				       "--workers objects: compare has that as two of its runs; give the "
				       "size of the pool, or leave it away");
	// the children would tell of a wrong scene five times
	ob_scene *scene = ob_scene_load(request.scene, &request.scene_options, &e);
	if (!scene || !ob_request_settle(&request, scene, &settings, &e)) {
		ob_scene_free(scene);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	uint32_t objects = scene->objects;
	ob_scene_free(scene);

	ob_comparison *c = calloc(1, sizeof *c);
	if (!c)
		return ob_command_fail(OB_EXIT_FAILED, "out of memory");
	plan p = { .arguments = a, .workers = request.workers };
	c->scene = request.scene;
	run_all(&p, c, objects);
	int code = ob_child_interrupted() ? ob_command_fail(OB_EXIT_FAILED, "interrupted") : tell(c, request.json);
	free(c);
	return code;
}
