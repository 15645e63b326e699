// Runs of a comparison, and values read from them.
#include "compare/compare.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "experiment/analysis.h"
#include "experiment/folder.h"
#include "experiment/json.h"
#include "experiment/process.h"

#define ROW(id, key, title, arch, isolation, workers, most, other, harden) \
	[OB_CONFIGURATION_##id] = { key, title, arch, isolation, OB_WORKERS_##workers, most, other, harden }
#define POOL(id, key, title, harden) ROW(id, "processes_" key, title, "obs", "process", POOL, 0, false, harden)
const ob_configuration ob_configuration_table[OB_CONFIGURATIONS] = {
	ROW(MONOLITH, "monolith", "monolith", "monolith", "thread", ONE, 0, false, NULL),
	ROW(THREAD, "thread_1", "1 thread", "obs", "thread", ONE, 0, false, NULL),
	ROW(THREADS_2, "threads_2", "2 threads", "obs", "thread", TWO, 0, false, NULL),
	ROW(THREADS, "threads", "thread pool", "obs", "thread", POOL, 0, false, NULL),
	ROW(PROCESSES, "processes", "process pool", "obs", "process", POOL, 0, false, NULL),
	ROW(GROUPS, "process_groups", "groups of 60", "obs", "process", GROUPS, 0, false, NULL),
	// with more than these, scheduling dominates on one workstation
	ROW(THREADS_EACH, "threads_each", "thread each", "obs", "thread", EACH, 4096, false, NULL),
	ROW(PROCESSES_EACH, "processes_each", "process each", "obs", "process", EACH, 1024, false, NULL),
	POOL(OUTBOX, "outbox", "outboxes", "outbox"),
	POOL(CHECKSUM, "checksum", "with checksum", "checksum"),
	POOL(PAGES, "pages", "with pages", "pages"),
	POOL(PRIVILEGES, "privileges", "privileges", "privileges"),
	POOL(LIMITS, "limits", "limits", "limits"),
	POOL(CALLS, "calls", "system calls", "calls"),
	POOL(HARDENED, "hardened", "hardened pool", ""),
	ROW(HARDENED_EACH, "processes_each_hardened", "hardened each", "obs", "process", EACH, 1024, false, ""),
	ROW(MONOLITH_OTHER, "monolith_other", "monolith", "monolith", "thread", ONE, 0, true, NULL),
	ROW(THREADS_OTHER, "threads_other", "thread pool", "obs", "thread", POOL, 0, true, NULL),
};

#define METRIC(id, key, title, unit, scale, group, meaning, kind, ...) \
	[OB_COMPARE_##id] = { key, title, unit, scale, NAN, group, meaning, OB_COMPARE_##kind, { __VA_ARGS__ } }
const ob_metric ob_compare_metric_table[OB_COMPARE_METRICS] = {
	METRIC(COST, "cpu_s_per_body_and_step", "CPU per body and step", "µs", 1e6, "Cost",
	       "CPU time of all workers, spinning and waking included, over bodies and steps", SAMPLE,
	       "body_step_cpu_us"),
	METRIC(WALL, "wall_s_per_simulated_s", "wall per simulated s", "ms", 1e3, NULL, "wall-clock time of stepping",
	       SAMPLE, "wall_s", "simulated_s"),
	METRIC(CPU, "cpu_s_per_simulated_s", "CPU per simulated s", "ms", 1e3, NULL, "CPU time of all workers", SAMPLE,
	       "cpu_s", "simulated_s"),
	METRIC(P50, "step_p50_s", "median", "ms", 1e3, "Latency of a step",
	       "wall-clock time from one step boundary to the next", SAMPLE, "step_p50_s"),
	METRIC(P90, "step_p90_s", "90 %", "ms", 1e3, NULL, "90th percentile of the steps", SAMPLE, "step_p90_s"),
	METRIC(P99, "step_p99_s", "99 %", "ms", 1e3, NULL, "so long or shorter were 99 %", SAMPLE, "step_p99_s"),
	METRIC(LONGEST, "step_max_s", "longest", "ms", 1e3, NULL, "the longest step of the run", SAMPLE, "step_max_s"),
	METRIC(CRITICAL, "critical_s_per_step", "critical path", "µs", 1e6, "Time of a step by cause",
	       "in each phase the worker with the most to do, and scheduling: what the step would take with a core for "
	       "every worker",
	       TIMED, "critical_s", "steps"),
	METRIC(SPEEDUP, "speedup_of_16", "speed-up, 16 workers", "1", 1, NULL,
	       "work over the critical path of 16 simulated workers: how much faster the steps could be with a core "
	       "for each of so many",
	       TIMED, "work_s", "critical_16_s"),
	METRIC(WORK, "work_s_per_step", "work, all simulators", "µs", 1e6, NULL,
	       "CPU time of everything but waiting, summed over all workers", TIMED, "work_s", "steps"),
	METRIC(GATE, "gate_s_per_step_and_worker", "at the gate, a worker", "µs", 1e6, NULL,
	       "wall-clock time in which a worker waits for the others", TIMED, "gate_s", "steps", "workers"),
	METRIC(GATE_CPU, "gate_cpu_s_per_step", "CPU of waiting", "µs", 1e6, NULL,
	       "CPU time of spinning, falling asleep and waking, all workers", TIMED, "gate_cpu_s", "steps"),
	METRIC(HELD, "held_s_per_step", "without a core", "µs", 1e6, NULL,
	       "wall-clock time in which workers had work and no core, all together", TIMED, "held_s", "steps"),
	METRIC(EXPLAINED, "explained", "share explained", "1", 1, NULL,
	       "work, waiting for a core, at the gate and for the host, over the time that the workers had", TIMED,
	       NULL),
	METRIC(PER_SIMULATOR, "cpu_s_per_simulator_and_simulated_s", "a simulator", "ms", 1e3,
	       "CPU by user, per simulated second", "CPU time of all workers over objects", SAMPLE, "cpu_s",
	       "simulated_s", "objects"),
	METRIC(HOST, "host_cpu_s_per_simulated_s", "host", "ms", 1e3, NULL,
	       "CPU time of the host's process without workers and renderer", SAMPLE, "host_cpu_s", "simulated_s"),
	METRIC(RENDERER, "renderer_cpu_s_per_simulated_s", "renderer", "ms", 1e3, NULL,
	       "CPU time of drawing, in a run with 60 frames of 640x480 per simulated second", DRAWN, "renderer_cpu_s",
	       "simulated_s"),
	METRIC(FPS, "frames_per_s", "frames drawn per s", "1", 1, NULL,
	       "frames that were drawn in that run, over its wall-clock time with start and end", DRAWN, "fps"),
	METRIC(SWITCHES, "switches_per_step", "switches per step", "1", 1, "What the system carries",
	       "involuntary context switches of workers", SAMPLE, "switches", "steps"),
	METRIC(STARTUP, "startup_s", "start-up", "ms", 1e3, NULL, "until every worker stood at the gate", SAMPLE,
	       "startup_s"),
	METRIC(STARTUP_EACH, "startup_s_per_simulator", "start-up, a simulator", "µs", 1e6, NULL, "that over objects",
	       SAMPLE, "startup_s", "objects"),
	METRIC(MEMORY, "memory_bytes", "memory", "MB", 1e-6, NULL,
	       "proportional set size of all processes, and the universe", SAMPLE, "memory_bytes"),
	METRIC(MEMORY_EACH, "memory_bytes_per_simulator", "memory, a simulator", "kB", 1e-3, NULL, "that over objects",
	       SAMPLE, "memory_bytes", "objects"),
	METRIC(MEMORY_WORKER, "memory_bytes_per_worker_process", "memory, a process", "MB", 1e-6, NULL,
	       "proportional set size of a worker where workers are processes", SAMPLE, "worker_memory_bytes",
	       "workers"),
	METRIC(PENETRATION, "penetration_mean_m", "penetration, end, mean", "mm", 1e3, "Error",
	       "of the pairs that penetrate", SAMPLE, "penetration_mean_m"),
	METRIC(WORST, "worst_penetration_m", "penetration, worst", "mm", 1e3, NULL, "at any step", MEASURED,
	       "worst_penetration_m"),
	METRIC(SEPARATION, "separation_mean_m", "separation, end, mean", "mm", 1e3, NULL,
	       "of contacts that carry an impulse", SAMPLE, "separation_mean_m"),
	METRIC(ENERGY, "energy_gain_max", "energy, largest gain", "1", 1, NULL,
	       "over the energy at the start, at any step", MEASURED, "energy_gain_max"),
	METRIC(MOMENTUM, "momentum_error", "momentum error", "1", 1, NULL, "of closed scenes only", MEASURED,
	       "momentum_error"),
	METRIC(OBJECTS, "objects", "objects", "1", 1, NULL, "", ANY, "objects"),
	METRIC(WORKERS, "workers", "workers", "1", 1, NULL, "", ANY, "workers"),
	METRIC(STEPS, "steps", "steps", "1", 1, NULL, "", ANY, "steps"),
};
#undef METRIC
_Static_assert((int)OB_COMPARE_METRICS <= (int)OB_METRICS, "they fit a record");

static bool is_monolith(ob_configuration_id id)
{
	return id == OB_CONFIGURATION_MONOLITH || id == OB_CONFIGURATION_MONOLITH_OTHER;
}

// Kind of trial that measures a metric.
static ob_compare_kind kind_of(ob_compare_metric m)
{
	const ob_compare_kind kind = (ob_compare_kind)ob_compare_metric_table[m].kind;
	return kind < OB_COMPARE_KINDS ? kind : OB_COMPARE_SAMPLE;
}

// Object simulators end in the same bits in any configuration: one is measured for all. The pool always runs.
static ob_configuration_id measured_for(ob_configuration_id id)
{
	return is_monolith(id)                           ? id
	       : ob_configuration_table[id].other_narrow ? OB_CONFIGURATION_THREADS_OTHER
							 : OB_CONFIGURATION_THREADS;
}

void ob_configuration_key(ob_configuration_id id, ob_compare_kind kind, char to[OB_CONFIGURATION_KEY])
{
	static const char *const kinds[OB_COMPARE_KINDS] = { "", ", each step", ", with frames" };
	snprintf(to, OB_CONFIGURATION_KEY, "%s%s", ob_configuration_table[id].key, kinds[kind]);
}

// ---- plan

bool ob_comparison_read_points(ob_comparison *c, const char *vary, ob_error *e)
{
	c->points = 1;
	if (!vary)
		return true;
	const char *value = strchr(vary, '=');
	if (!value || value == vary || !value[1])
		return ob_fail(e, "--vary %s: expected NAME=VALUE,VALUE, as in --vary n=100,1000", vary);
	int name = (int)(value - vary);
	for (c->points = 0, value++; value; value = strchr(value, ','), value += value != NULL) {
		if (c->points == OB_SWEEP_POINTS)
			return ob_fail(e, "--vary %s: at most %d values", vary, OB_SWEEP_POINTS);
		snprintf(c->point[c->points++].define, sizeof c->point->define, "%.*s=%.*s", name, vary,
			 (int)strcspn(value, ","), value);
	}
	return true;
}

static uint32_t count_workers(ob_worker_count count, uint32_t objects, uint32_t pool)
{
	switch (count) {
	case OB_WORKERS_ONE:
		return 1;
	case OB_WORKERS_TWO:
		return 2;
	case OB_WORKERS_POOL:
		return pool;
	case OB_WORKERS_GROUPS:
		return (objects + OB_COMPARE_GROUP - 1) / OB_COMPARE_GROUP;
	case OB_WORKERS_EACH:
		return objects;
	}
	return 1;
}

// Hardened configurations run only if their measures are to be priced.
static bool is_asked(const ob_comparison *c, ob_configuration_id id)
{
	const char *list = ob_configuration_table[id].harden;
	uint32_t measures;
	ob_error e;
	return !list || (*list ? ob_harden_read(&measures, list, &e) && !(measures & ~c->harden) : c->harden);
}

static void plan_point(const ob_comparison *c, ob_sweep_point *p)
{
	for (int i = 0; i < OB_CONFIGURATIONS; i++) {
		const ob_configuration *w = &ob_configuration_table[i];
		char *why = p->skipped[i];
		size_t room = sizeof p->skipped[i];
		p->workers[i] = count_workers(w->workers, p->objects, c->pool);
		*why = 0;
		if ((i == OB_CONFIGURATION_THREAD || i == OB_CONFIGURATION_THREADS_2) && p->workers[i] == c->pool)
			snprintf(why, room, "the pool has as many");
		else if (i == OB_CONFIGURATION_GROUPS && p->workers[i] < 2)
			snprintf(why, room, "%" PRIu32 " objects are one group", p->objects);
		else if (p->joints > 0 && w->other_narrow && strcmp(w->arch, "monolith") != 0)
			snprintf(why, room, "only true shapes have joints");
		else if (w->objects_max && p->objects > w->objects_max && is_asked(c, i))
			snprintf(why, room, "%" PRIu32 " objects are more than the %" PRIu32 " that are tried",
				 p->objects, w->objects_max);
	}
}

static bool hash_file(uint64_t *hash, const char *path, ob_error *e)
{
	char bytes[4096];
	FILE *f = fopen(path, "re");
	if (!f)
		return ob_fail(e, "%s: %m", path);
	for (size_t n; (n = fread(bytes, 1, sizeof bytes, f));)
		*hash = ob_hash_on(*hash, bytes, n);
	bool fine = !ferror(f);
	fclose(f);
	return fine || ob_fail(e, "%s cannot be read", path);
}

bool ob_comparison_plan(ob_comparison *c, ob_error *e)
{
	uint64_t hash = OB_HASH_BEGIN;
	const char *slash = strrchr(c->scene, '/');
	if (!hash_file(&hash, c->scene, e))
		return false;
	hash = ob_hash_on(hash, c->options, strlen(c->options));
	for (uint32_t i = 0; i < c->points; i++) {
		ob_sweep_point *p = &c->point[i];
		plan_point(c, p);
		// a changed scene, or another option, is another case
		int n = snprintf(p->key, sizeof p->key, "%.80s%s%s", slash ? slash + 1 : c->scene,
				 *p->define ? " " : "", p->define);
		snprintf(p->key + n, sizeof p->key - (size_t)n, " @%016" PRIx64,
			 ob_hash_on(hash, p->define, strlen(p->define)));
	}
	return true;
}

// ---- one run

char **ob_comparison_arguments(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			       ob_compare_kind kind, bool timed, uint64_t seed)
{
	enum { OWN = 20 };
	const ob_configuration *w = &ob_configuration_table[id];
	char **argv = calloc(OWN + OB_COMPARE_OPTIONS, sizeof *argv);
	size_t n = 0;
	bool fine = argv != NULL;
#define ADD(...) (fine = fine && asprintf(&argv[n++], __VA_ARGS__) >= 0)
	ADD("obsim");
	ADD("run");
	ADD("--json=-");
	ADD("--arch=%s", w->arch);
	ADD("--isolation=%s", w->isolation);
	if (w->harden)
		ADD("--harden%s%s", *w->harden ? "=" : "", w->harden);
	ADD("--set=narrow=%s", w->other_narrow ? c->other : c->narrow);
	ADD("--seed=%" PRIu64, seed);
	ADD("--set=measure=%s", kind == OB_COMPARE_MEASURED ? "step" : timed ? "profile" : "end");
	if (kind == OB_COMPARE_DRAWN) {
		ADD("--out=/dev/null");
		ADD("--size=640x480");
		ADD("--set=samples=1");
	}
	if (w->workers == OB_WORKERS_EACH)
		ADD("--workers=objects");
	else if (!is_monolith(id))
		ADD("--workers=%" PRIu32, p->workers[id]);
	for (uint32_t i = 0; i < c->passed; i++)
		if (!c->pass[i].objects_only || !is_monolith(id))
			ADD("%s", c->pass[i].text);
	if (*p->define)
		ADD("-D%s", p->define);
	ADD("--");
	ADD("%s", c->scene);
#undef ADD
	return argv;
}

typedef struct job {
	const ob_comparison *comparison;
	const ob_sweep_point *point;
	ob_configuration_id id;
	ob_compare_kind kind;
} job;

// Report of a run, malloc'd; NULL and e if it failed.
static char *run_once(const ob_trial *t, bool timed, ob_error *e)
{
	const job *j = t->what;
	char *report =
		ob_program_report(ob_comparison_arguments(j->comparison, j->point, j->id, j->kind, timed, t->seed), e);
	if (!report || ob_json_find(report, "state_hash"))
		return report;
	ob_fail(e, "its report cannot be read");
	free(report);
	return NULL;
}

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e);
static const ob_experiment experiment = {
	.name = "compare", .metrics = OB_COMPARE_METRICS, .metric = ob_compare_metric_table, .run = run_trial
};

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e)
{
	const job *j = t->what;
	double *m = out->metric;
	char *r = run_once(t, false, e), *timed = NULL;
	bool fine = r && (j->kind != OB_COMPARE_SAMPLE || (timed = run_once(t, true, e)));
	if (fine) {
		ob_record_read(out, &experiment, (int)j->kind, r);
		ob_record_read(out, &experiment, OB_COMPARE_ANY, r);
		m[OB_COMPARE_COST] *= 1e-6;
		if (!(m[OB_COMPARE_MEMORY_WORKER] > 0))
			m[OB_COMPARE_MEMORY_WORKER] = NAN;
		fine = ob_json_read_string(ob_json_find(r, "state_hash"), out->note, sizeof out->note) ||
		       ob_fail(e, "its report cannot be read");
	}
	if (fine && timed) {
		ob_record_read(out, &experiment, OB_COMPARE_TIMED, timed);
		m[OB_COMPARE_EXPLAINED] =
			(ob_json_read_number(timed, "work_s") + ob_json_read_number(timed, "held_s") +
			 ob_json_read_number(timed, "gate_s") + ob_json_read_number(timed, "idle_s")) /
			(ob_json_read_number(timed, "workers") * ob_json_read_number(timed, "elapsed_s"));
	}
	free(r);
	free(timed);
	return fine;
}

// ---- schedule

// Estimates the seconds of a trial: object simulators take some microseconds for a body and step, plus the workers'
// start.
static double guess(const job *j)
{
	static const double body_step_s = 4e-6, thread_s = 2e-4, process_s = 2e-3, process_own_s = .02, frame_s = .03;
	const ob_sweep_point *p = j->point;
	bool processes = ob_configuration_table[j->id].isolation[0] == 'p';
	double run = process_own_s + p->workers[j->id] * (processes ? process_s : thread_s) +
		     p->objects * (double)p->steps * body_step_s;
	return j->kind == OB_COMPARE_SAMPLE     ? 2 * run
	       : j->kind == OB_COMPARE_MEASURED ? 1.5 * run
						: run + 60 * p->simulated * frame_s;
}

static bool add_trial(ob_trials *s, const job *j, uint32_t seed)
{
	ob_trial t = { .seed = j->point->seed + seed, .guess_s = guess(j), .what = j };
	if (*j->point->skipped[j->id] || !is_asked(j->comparison, j->id))
		return true;
	memcpy(t.of, j->point->key, sizeof t.of);
	ob_configuration_key(j->id, j->kind, t.configuration);
	return ob_trials_add(s, &t);
}

typedef job jobs[OB_SWEEP_POINTS][OB_CONFIGURATIONS][OB_COMPARE_KINDS];

// Schedules repeat by repeat, seed by seed, point by point, to and fro, so that other load of the machine affects all
// alike; then the trials that run once.
static bool schedule(const ob_comparison *c, jobs *all, ob_trials *s)
{
	bool fine = true;
	for (uint32_t i = 0; i < c->points; i++)
		for (int w = 0; w < OB_CONFIGURATIONS; w++)
			for (int k = 0; k < OB_COMPARE_KINDS; k++)
				(*all)[i][w][k] = (job){ c, &c->point[i], w, k };
	for (uint32_t seed = 0; seed < c->seeds; seed++)
		for (uint32_t i = 0; i < c->points; i++)
			for (int w = 0; fine && w < OB_CONFIGURATIONS; w++)
				fine = add_trial(
					s, &(*all)[i][seed % 2 ? OB_CONFIGURATIONS - 1 - w : w][OB_COMPARE_SAMPLE],
					seed);
	fine = fine && ob_trials_repeat(s, 0, c->repeats, OB_ORDER_TO_AND_FRO, false);
	for (uint32_t seed = 0; seed < c->seeds; seed++)
		for (uint32_t i = 0; i < c->points; i++)
			for (int w = 0; fine && w < OB_CONFIGURATIONS; w++)
				fine = measured_for(w) != (ob_configuration_id)w ||
				       add_trial(s, &(*all)[i][w][OB_COMPARE_MEASURED], seed);
	for (uint32_t i = 0; i < c->points; i++)
		for (int w = 0; fine && c->drawn && w < OB_CONFIGURATIONS; w++)
			fine = add_trial(s, &(*all)[i][w][OB_COMPARE_DRAWN], 0);
	return fine;
}

// Picks the scheduled records: a folder may hold more, of other points, repeats, seeds.
static bool pick(ob_records *to, const ob_records *from, const ob_trials *s)
{
	memcpy(to->machine, from->machine, sizeof to->machine);
	memcpy(to->commit, from->commit, sizeof to->commit);
	bool fine = true;
	for (size_t i = 0; fine && i < from->count; i++) {
		const ob_record *r = &from->record[i];
		bool asked = false;
		for (size_t j = 0; j < s->count && !asked; j++) {
			const ob_trial *t = &s->trial[j];
			asked = r->seed == t->seed && (r->repeat == t->repeat || r->failure) &&
				!strcmp(r->configuration, t->configuration) && !strcmp(r->of, t->of);
		}
		fine = !asked || ob_records_add(to, r);
	}
	return fine;
}

bool ob_comparison_run(ob_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e)
{
	ob_experiment x = experiment;
	x.commit = commit;
	jobs *all = malloc(sizeof *all);
	ob_trials s = { 0 };
	ob_records r = { 0 };
	bool fine = (all && schedule(c, all, &s)) || ob_fail(e, "out of memory");
	fine = fine && ob_experiment_open(&x, folder, &r, e);
	if (fine && fresh)
		ob_records_drop(&r, &s);
	fine = fine && ob_experiment_run(&x, &s, &r, folder, e);
	fine = fine && (pick(&c->records, &r, &s) || ob_fail(e, "out of memory"));
	ob_records_finish(&r);
	ob_trials_finish(&s);
	free(all);
	return fine;
}

void ob_comparison_finish(ob_comparison *c)
{
	for (uint32_t i = 0; i < c->passed; i++)
		free(c->pass[i].text);
	c->passed = 0;
	ob_records_finish(&c->records);
}

// ---- results

ob_estimate ob_comparison_spread(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
				 ob_compare_metric m)
{
	char key[OB_CONFIGURATION_KEY];
	ob_compare_kind kind = kind_of(m);
	if (!ob_comparison_is_done(c, p, id))
		return (ob_estimate){ 0, NAN, NAN, NAN, false };
	ob_configuration_key(kind == OB_COMPARE_MEASURED ? measured_for(id) : id, kind, key);
	ob_statistics s = ob_records_summarise(&c->records, p->key, key, m);
	return ob_estimate_median(&s);
}

ob_estimate ob_comparison_ratio(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id of,
				ob_configuration_id to, ob_compare_metric m)
{
	if (!ob_comparison_is_done(c, p, of) || !ob_comparison_is_done(c, p, to))
		return (ob_estimate){ 0, NAN, NAN, NAN, false };
	ob_statistics s = ob_records_ratio(&c->records, p->key, ob_configuration_table[of].key,
					   ob_configuration_table[to].key, m, false);
	return ob_estimate_median(&s);
}

ob_configuration_id ob_configuration_without(ob_configuration_id id)
{
	switch (id) {
	case OB_CONFIGURATION_CHECKSUM:
	case OB_CONFIGURATION_PAGES:
		return OB_CONFIGURATION_OUTBOX;
	case OB_CONFIGURATION_HARDENED_EACH:
		return OB_CONFIGURATION_PROCESSES_EACH;
	default:
		return ob_configuration_table[id].harden ? OB_CONFIGURATION_PROCESSES : OB_CONFIGURATIONS;
	}
}

// Runs with frames may fail on machines that cannot draw.
const char *ob_comparison_failure(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id)
{
	const ob_record *failed = NULL;
	for (ob_compare_kind kind = OB_COMPARE_SAMPLE; kind <= OB_COMPARE_MEASURED && !failed; kind++) {
		char key[OB_CONFIGURATION_KEY];
		ob_configuration_key(id, kind, key);
		ob_records_have(&c->records, p->key, key, &failed);
	}
	return failed ? failed->reason : NULL;
}

bool ob_comparison_is_done(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id)
{
	return ob_records_have(&c->records, p->key, ob_configuration_table[id].key, NULL) &&
	       !ob_comparison_failure(c, p, id);
}

// Object simulators of the record; NULL: it is a monolith's, or failed, or another case's.
static const ob_configuration *object_simulators_of(const ob_sweep_point *p, const ob_record *r)
{
	size_t n = strcspn(r->configuration, ",");
	for (int w = 0; w < OB_CONFIGURATIONS && !r->failure && !strcmp(r->of, p->key); w++)
		if (strlen(ob_configuration_table[w].key) == n &&
		    !strncmp(ob_configuration_table[w].key, r->configuration, n))
			return is_monolith(w) ? NULL : &ob_configuration_table[w];
	return NULL;
}

bool ob_comparison_agrees(const ob_comparison *c, const ob_sweep_point *p)
{
	for (size_t i = 0; i < c->records.count; i++) {
		const ob_record *a = &c->records.record[i];
		const ob_configuration *of = object_simulators_of(p, a);
		for (size_t j = 0; of && j < i; j++) {
			const ob_record *b = &c->records.record[j];
			const ob_configuration *other = object_simulators_of(p, b);
			if (other && other->other_narrow == of->other_narrow && a->seed == b->seed &&
			    strcmp(a->note, b->note) != 0)
				return false;
		}
	}
	return true;
}
