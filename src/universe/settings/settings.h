// Settings of a run: stepping and solving, free running, watching. One record for scene files, the command line, the
// host, the shared table, the engines and reports, and one table of its members (OB_SETTING_LIST): names, ranges, help.
// Pure; any thread.
#ifndef OB_SETTINGS_SETTINGS_H
#define OB_SETTINGS_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>
#include <ob/vec.h>

typedef enum ob_solver_kind {
	OB_SOLVER_COLOURED, // contact after contact, each on the state that the one before published
	OB_SOLVER_JACOBI, // all contacts on the same state, masses split between the contacts of a body
	OB_SOLVER_GHOST, // each treats its neighbours as infinitely heavy: wrong by design, for demonstration
	OB_SOLVER_LAGGED, // each computes the contact's impulse for itself, on a delayed state of its partner
} ob_solver_kind;

// True if the two bodies of a pair do not agree on one impulse.
static inline bool ob_solver_is_two_sided(uint32_t kind)
{
	return kind == OB_SOLVER_GHOST || kind == OB_SOLVER_LAGGED;
}

typedef enum ob_integrator {
	OB_INTEGRATOR_EXACT, // free motion in closed form
	OB_INTEGRATOR_ODE, // by ODE's stepper
} ob_integrator;

typedef enum ob_narrow_phase {
	OB_NARROW_OBB, // objects touch if their shapes do, in any attitude
	OB_NARROW_AABB, // objects touch if their axis-aligned bounding boxes overlap
} ob_narrow_phase;

// Names of the values of an enum or a switch, in the order of their numbers.
#define OB_ARCHITECTURE_NAMES "obs|monolith"
#define OB_SOLVER_NAMES "coloured|jacobi|ghost|lagged"
#define OB_INTEGRATOR_NAMES "exact|ode"
#define OB_NARROW_PHASE_NAMES "obb|aabb"
#define OB_SWITCH_NAMES "off|on"

// Faults injected into a run, to test how it survives them (--fault).
typedef enum ob_fault_kind {
	OB_FAULT_KILL, // a simulator's process kills itself
	OB_FAULT_SEGV, // a simulator's process reads an unmapped address
	OB_FAULT_EXIT, // a simulator's process exits in the middle of its work
	OB_FAULT_STOP, // a simulator's process stops (SIGSTOP) for good
	OB_FAULT_SLOW, // a simulator sleeps
	OB_FAULT_SCRIBBLE, // a simulator's process stores random words anywhere in the universe where it can write
	OB_FAULT_NOSPACE, // a checkpoint cannot be written, as on a full disk
	OB_FAULT_NOPAGES, // the universe cannot grow, as in a full /dev/shm
	OB_FAULT_ABORT, // a simulator's process reports on standard error and aborts, as an assertion does
	OB_FAULT_KINDS
} ob_fault_kind;
#define OB_FAULT_NAMES "kill|segv|exit|stop|slow|scribble|nospace|nopages|abort"

// A simulator may fail after each solved island, at the end of each phase, and after scheduling the next. The draw
// depends on the seed, its worker's number, the number of restarts of all, and the number of chances since.
typedef struct ob_fault_plan {
	double probability; // at each chance; 0 = no faults
	uint64_t seed;
	uint32_t kinds; // bits, 1 << ob_fault_kind: one is drawn
	uint32_t words; // SCRIBBLE: number of words
	uint32_t sleep_ms; // SLOW: duration
	uint32_t zero;
} ob_fault_plan;

// Draws the fault at a chance (from 0) of a worker; OB_FAULT_KINDS: none. among: kinds possible at this place. random:
// for more draws.
ob_fault_kind ob_fault_draw(const ob_fault_plan *p, uint32_t among, uint32_t worker, uint64_t chance, uint64_t *random);

// Measures that limit the damage by a faulty simulator process (--harden; host/confine.h describes each).
typedef enum ob_harden_measure {
	OB_HARDEN_OUTBOX, // it submits results to an outbox; the arranger checks and writes them (table/outbox.h)
	OB_HARDEN_CHECKSUM, // outbox records carry a checksum; needs OUTBOX
	OB_HARDEN_PAGES, // it maps the universe read-only, except for its own outbox; needs OUTBOX
	OB_HARDEN_PRIVILEGES, // it runs without root and capabilities
	OB_HARDEN_LIMITS, // limits on resources
	OB_HARDEN_CALLS, // few system calls are allowed
	OB_HARDEN_MEASURES
} ob_harden_measure;
#define OB_HARDEN_NAMES "outbox|checksum|pages|privileges|limits|calls"
enum { OB_HARDEN_ALL = (1 << OB_HARDEN_MEASURES) - 1 }; // bits, 1 << ob_harden_measure

// Reads a list such as "pages,calls", and adds the measures that these need; "": all, NULL: none. Returns false and e
// on an unknown word.
bool ob_harden_read(uint32_t *measures, const char *list, ob_error *e);

// Settings, fixed for a run. They lie in the table, so that every process reads the same: a fixed size, no pointers.
typedef struct ob_run_settings {
	ob_vec3 gravity; // m/s^2
	double step_length; // s
	double tolerance; // m; > 0: each island chooses its substeps so that its error stays below
	uint32_t substeps; // per step, >= 1; with a tolerance: the minimum
	uint32_t
		iterations; // contact solver iterations per substep, at most; of a monolith: QuickStep's, 0 = exact solver
	uint32_t solver; // ob_solver_kind
	uint32_t lag; // OB_SOLVER_LAGGED: delay of a partner's state in iterations
	uint32_t integrator; // ob_integrator
	uint32_t narrow_phase; // ob_narrow_phase
	uint32_t sleeping; // 1 = islands may fall asleep
	uint32_t monolith; // 1 = one ODE world holds all objects
	uint32_t one_per_object; // 1 = worker i runs object i and nothing else; set by the host
	uint32_t timed; // 1 = counters measure each section of the step
	uint32_t load; // > 0: each test of two axis-aligned boxes adds up 1 + 2 + .. + load
	uint32_t freezes; // 1 = unsolvable bodies are frozen: budgets are per island; set by the host
	uint32_t verify; // 1 = a sample of islands is solved finely besides, to know their errors
	uint32_t
		budget; // > 0: most work of a step, or an island, in units of 2^15 (schedule/calendar.h); set by the host
	ob_fault_plan fault;
} ob_run_settings;

typedef enum ob_coupling {
	OB_COUPLING_GROUP, // bodies that may touch are solved together, by lockstep's own step
	OB_COUPLING_OWN, // each simulator computes its own response to its neighbours
} ob_coupling;

#define OB_COUPLING_NAMES "group|own"
#define OB_SYNC_NAMES "lockstep|free"
#define OB_UPDATE_RATE_MOST 1e5 // Hz, of a run and of an object

// Settings of a free run (obsim run --sync free): simulators have times of their own, and no gate (docs/design/free.md). They
// lie in the table, too.
typedef struct ob_free_settings {
	double update_rate; // Hz, of objects without one of their own; 0: the run is in lockstep
	double rate_most; // Hz, of any object
	double max_lag; // s that a simulator may be ahead of a neighbour; infinity: no bound
	double jitter; // 0 .. 1: share by which lengths of steps vary
	double delay; // s of own time after which a publication is seen
	double pace; // simulated seconds a second; infinity: as fast as possible
	double end; // s: no simulator goes beyond
	uint64_t seed; // of the jitter
	uint32_t coupling; // ob_coupling
	uint32_t heavy; // OB_COUPLING_OWN: 1 = neighbours count as infinitely heavy, 0 = as heavy as they are
	uint32_t objects; // of the scene: they are dealt to workers in blocks
	uint32_t replays; // 1 = the schedule is replayed, 0 = it is recorded
	char schedule[256]; // path of the schedule's file (free/schedule.h); "" = none
} ob_free_settings;

// Factors of thresholds that have a unit: 1 at the default tolerance, or without one. So a run stays the same when
// lengths, tolerance and times (as the square root of lengths; gravity stays) are all scaled.
typedef struct ob_units {
	double length, time, speed;
} ob_units;
ob_units ob_run_settings_units(const ob_run_settings *s);

// Defaults. An explicit tolerance chooses the substeps from ob_run_settings_least_substeps() up.
#define OB_DEFAULT_STEP (1. / 60) // s
#define OB_DEFAULT_TOLERANCE 1e-3 // m
#define OB_GRAVITY_MOST 1e4 // m/s^2 along each axis
enum {
	OB_DEFAULT_SUBSTEPS = 8,
	OB_DEFAULT_ITERATIONS = 16, // object simulators
	OB_DEFAULT_TOLERANCE_ITERATIONS = 64, // object simulators with an explicit tolerance
	OB_DEFAULT_MONOLITH_ITERATIONS = 20, // ODE's own default
};

// Most substeps that a tolerance chooses.
#define OB_MAX_SUBSTEPS 1024
// Substeps of the fine solution that a run's own is verified with.
#define OB_VERIFY_SUBSTEPS 512

// Fewest substeps that a tolerance (m) chooses from: 8, and fewer only for tolerances coarser than the default. The
// error estimate misses some errors (a pivot's energy, a slow creep), so a smaller tolerance never starts from less.
uint32_t ob_run_settings_least_substeps(double tolerance);

// Ratio by which a run with a tolerance is coarser than the default: its substeps are at least so many times as long.
// 1 at the default, at any smaller tolerance, and without one. It has no unit, so rescaling a run does not change it.
double ob_run_settings_coarseness(const ob_run_settings *s);

// Coloured solver, exact integrator, at least 8 substeps with the default tolerance, sleeping.
ob_run_settings ob_run_settings_default(void);

// Figures measured in a run.
typedef enum ob_measure_when {
	OB_MEASURE_STEPS, // each step
	OB_MEASURE_PROFILE, // start and end, and the workers' time by section
	OB_MEASURE_ENDS, // the start and the end
} ob_measure_when;
#define OB_MEASURE_NAMES "step|profile|end"

// Settings of a scene or a command line, with those that it gives.
typedef struct ob_settings {
	ob_run_settings run; // first
	uint64_t given; // bits, 1 << ob_setting_id; all other members mean nothing, or are defaults
	ob_free_settings free;
	double tolerance_share; // tolerance by the thickness of the thinnest body; 0: it is a length
	double patience, every; // s
	const char *restarts, *gpu, *record_schedule, *replay_schedule;
	uint32_t sync; // 1 = free
	uint32_t measure; // ob_measure_when
	uint32_t samples;
} ob_settings;

// The table of settings, from which --set, its help, the manual page, completions, fields of scenes and error texts
// follow. A row: id, name everywhere, kind, member of ob_settings, group, flags, least and most of numbers, form of the
// value (CHOICE, SWITCH: the names of all), help with the default in brackets.
#define OB_SETTING_LIST(X) \
	X(ARCHITECTURE, "arch", CHOICE, run.monolith, SOLVED, OPTION, 0, 0, OB_ARCHITECTURE_NAMES, \
	  "one simulator per object, or one ODE world that holds all (obs)") \
	X(STEP, "step", REAL, run.step_length, SOLVED, OPTION | SCENE, 1e-9, 10, "H", \
	  "seconds a step, as .01 or 1/60 (the scene's)") \
	X(TOLERANCE, "tolerance", REAL, run.tolerance, SOLVED, OPTION | SCENE | OBJECTS, 1e-6, 1, "LENGTH|P%", \
	  "error that objects that touch may reach, as .5mm or .1% of the thinnest") \
	X(SUBSTEPS, "substeps", COUNT, run.substeps, SOLVED, SCENE, 1, 1000, "N", \
	  "substeps a step (the scene's; monolith: 1)") \
	X(ITERATIONS, "iterations", COUNT, run.iterations, SOLVED, SCENE, 0, 100000, "N", \
	  "of the contact solver a substep (the scene's; monolith: 20, 0 = exact)") \
	X(SOLVER, "solver", CHOICE, run.solver, SOLVED, SCENE | OBJECTS, 0, 0, OB_SOLVER_NAMES, \
	  "how contacts are solved (the scene's)") \
	X(LAG, "lag", COUNT, run.lag, SOLVED, SCENE | OBJECTS, 0, 256, "K", \
	  "lagged: iterations that a partner's state is late (1)") \
	X(INTEGRATOR, "integrator", CHOICE, run.integrator, SOLVED, SCENE | OBJECTS, 0, 0, OB_INTEGRATOR_NAMES, \
	  "free motion in closed form, or by ODE's stepper (the scene's)") \
	X(SLEEPING, "sleeping", SWITCH, run.sleeping, SOLVED, SCENE, 0, 0, OB_SWITCH_NAMES, \
	  "whether what rests may sleep (the scene's)") \
	X(NARROW_PHASE, "narrow", CHOICE, run.narrow_phase, SOLVED, 0, 0, 0, OB_NARROW_PHASE_NAMES, \
	  "objects touch as they are, or as boxes along the axes (obb)") \
	X(LOAD, "load", COUNT, run.load, SOLVED, 0, 0, 1e9, "N", "add up 1 to N in each test of two boxes (0)") \
	X(SYNC, "sync", CHOICE, sync, FREE, OPTION | SCENE, 0, 0, OB_SYNC_NAMES, \
	  "all step together, or each at its own times (the scene's)") \
	X(UPDATE_RATE, "update_rate", REAL, free.update_rate, FREE, ABOVE | SCENE, 0, OB_UPDATE_RATE_MOST, "HZ", \
	  "steps of a simulator a second (the scene's)") \
	X(COUPLING, "coupling", CHOICE, free.coupling, FREE, SCENE, 0, 0, OB_COUPLING_NAMES, \
	  "who computes an impulse: one for a group, or each its own (the scene's)") \
	X(MAX_LAG, "max_lag", REAL, free.max_lag, FREE, ABOVE | SCENE, 0, 1e3, "S|none", \
	  "seconds ahead of a neighbour (the scene's; pace max: two steps; else none)") \
	X(JITTER, "jitter", REAL, free.jitter, FREE, 0, 0, .9, "P", "share by which lengths of steps vary (0)") \
	X(DELAY, "delay", REAL, free.delay, FREE, 0, 0, 10, "S", "seconds until a publication is seen (0)") \
	X(RECORD_SCHEDULE, "record_schedule", TEXT, record_schedule, RUN, 0, 0, 0, "FILE", \
	  "free: record who stepped when, and read what, to repeat the run") \
	X(REPLAY_SCHEDULE, "replay_schedule", TEXT, replay_schedule, RUN, 0, 0, 0, "FILE", \
	  "repeat a free run to the bit, in one thread") \
	X(VERIFY, "verify", SWITCH, run.verify, RUN, 0, 0, 0, OB_SWITCH_NAMES, \
	  "solve a sample of steps again with 512 substeps, and print the errors (off)") \
	X(MEASURE, "measure", CHOICE, measure, RUN, 0, 0, 0, OB_MEASURE_NAMES, \
	  "each step, where the time goes, or neither (step)") \
	X(EVERY, "every", REAL, every, RUN, ABOVE, 0, 1e9, "S", \
	  "simulated seconds from one checkpoint to the next (1)") \
	X(SAMPLES, "samples", COUNT, samples, RUN, 0, 1, 256, "N", "samples a pixel (draft: 4 on a GPU; fine: 16)") \
	X(GPU, "gpu", TEXT, gpu, RUN, 0, 0, 0, "WHICH", "surfaceless, or the number of a GPU (the first that works)") \
	X(PATIENCE, "patience", REAL, patience, WATCHED, ABOVE, 0, 1e9, "S", \
	  "seconds that a step may take until it counts as stalled (60)") \
	X(RESTARTS, "restarts", TEXT, restarts, WATCHED, 0, 0, 0, "N/S", \
	  "end the run at more than N deaths within S seconds (no limit)")

typedef enum ob_setting_id {
#define X(id, ...) OB_SETTING_##id,
	OB_SETTING_LIST(X)
#undef X
		OB_SETTINGS,
	OB_RUN_SETTINGS = OB_SETTING_SYNC, // all before it are settings of lockstep, which records and checkpoints list
} ob_setting_id;

typedef enum ob_setting_kind {
	OB_SETTING_REAL, // double, in its unit
	OB_SETTING_COUNT, // uint32_t
	OB_SETTING_CHOICE, // uint32_t, a number among names
	OB_SETTING_SWITCH, // uint32_t, 0 or 1; in a scene true or false
	OB_SETTING_TEXT, // const char *
} ob_setting_kind;

typedef enum ob_setting_group {
	OB_SETTING_SOLVED, // by which scenes are solved
	OB_SETTING_FREE, // of free running
	OB_SETTING_WATCHED, // limits of a host on its simulators
	OB_SETTING_RUN, // results of obsim run
} ob_setting_group;

enum {
	OB_SETTING_SCENE = 1, // it is a field of scenes, too
	OB_SETTING_OPTION = 2, // it has an option of its own in place of --set
	OB_SETTING_ABOVE = 4, // least itself is too small
	OB_SETTING_OBJECTS = 8, // means nothing to a monolith
};

typedef struct ob_setting {
	const char *name;
	ob_setting_kind kind;
	size_t offset; // in ob_settings, and of lockstep settings in ob_run_settings
	ob_setting_group group;
	uint32_t flags;
	double least, most;
	const char *form, *help; // a form of a real that ends in |none: none is no bound
} ob_setting;

extern const ob_setting ob_setting_table[OB_SETTINGS];

// Number of a setting by its name, or by that of earlier versions; -1: there is none.
int ob_setting_by_name(const char *name);

static inline bool ob_setting_is_set(const ob_settings *layer, ob_setting_id id)
{
	return layer->given >> id & 1;
}
// Overwrites settings with those that a layer gives.
void ob_settings_overlay(ob_settings *s, const ob_settings *layer);
// The same for those of lockstep. A tolerance replaces a number of substeps, and a number of substeps a tolerance. gravity
// does not belong to a layer.
void ob_run_settings_overlay(ob_run_settings *s, const ob_settings *layer);

// Resolves the settings of a run: s (a scene's), the requested layer (NULL = none), then the defaults of the architecture.
// Solvers that are wrong by design keep only an explicit tolerance, as more substeps would not help them. lag is 0 unless
// the solver reads it. If ODE's stepper alone would miss the tolerance, it takes more substeps. Returns false and e on a
// setting without meaning for the architecture or the solver.
bool ob_run_settings_resolve(ob_run_settings *s, const ob_settings *layer, ob_error *e);

// True if settings from outside are valid for a run: numbers in their ranges, choices among their names. Returns false
// and e, naming the first invalid one.
bool ob_run_settings_check(const ob_run_settings *s, ob_error *e);

// Finds the number of a word in "a|b|c"; false if absent.
bool ob_setting_find(const char *names, const char *word, uint32_t *value);
typedef struct ob_setting_word {
	char text[32];
} ob_setting_word;
// Word of a choice's or switch's value, among those of lockstep.
ob_setting_word ob_setting_print(const ob_run_settings *s, ob_setting_id id);
// The setting on a command line, without the dashes: "tolerance", "set lag".
ob_setting_word ob_setting_option(ob_setting_id id);

// Words of earlier versions, still accepted in command lines and scenes: the present name of an option, field or choice
// for a former one. NULL: unchanged.
const char *ob_setting_renamed(const char *former);
const char *ob_setting_former(const char *name);

// ---- length

// Lengths as people write them, in scenes and on the command line alike. Pure; any thread.

// One of the two is above 0: a length (m), or a share of another length. Neither: not set.
typedef struct ob_length {
	double m, share;
} ob_length;

// Reads a length with its unit, or in metres, or a share up to 100%. The range of a length is the caller's.
bool ob_length_read(const char *text, ob_length *out);
#define OB_LENGTH_FORMS "a length, as .5mm or .0005 (m), or a share above 0%, up to 100%, as .1%"

#endif
