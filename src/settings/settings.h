// Settings of a run: stepping and solving. One record for scene files, the command line, the host, the shared
// table, the engines and reports, and one description of its members: names, units, ranges.
//
// A layer of settings, from a scene or a command line, is the same record with unset members for all others. Pure; any
// thread.
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
	uint32_t budget; // > 0: most work of a step, or an island, in units of 2^15 (schedule/work.h); set by the host
	ob_fault_plan fault;
} ob_run_settings;

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

typedef enum ob_setting_id {
	OB_SETTING_ARCHITECTURE,
	OB_SETTING_STEP,
	OB_SETTING_TOLERANCE,
	OB_SETTING_SUBSTEPS,
	OB_SETTING_ITERATIONS,
	OB_SETTING_SOLVER,
	OB_SETTING_LAG,
	OB_SETTING_INTEGRATOR,
	OB_SETTING_SLEEPING,
	OB_SETTING_NARROW_PHASE,
	OB_SETTING_LOAD,
	OB_SETTINGS
} ob_setting_id;

typedef enum ob_setting_kind {
	OB_SETTING_REAL, // double, in its unit
	OB_SETTING_COUNT, // uint32_t
	OB_SETTING_CHOICE, // uint32_t, a number among names
	OB_SETTING_SWITCH, // uint32_t, 0 or 1; in a scene true or false
} ob_setting_kind;

typedef struct ob_setting {
	const char *name; // name of the option, the scene's field and the report's key
	ob_setting_kind kind;
	size_t offset; // in ob_run_settings
	double least, most; // of numbers
	bool above; // least itself is too small
	const char *unit; // "" = none
	const char *names; // CHOICE, SWITCH: "a|b|c"
} ob_setting;

extern const ob_setting ob_setting_table[OB_SETTINGS];

// Layer without any setting.
ob_run_settings ob_run_settings_unset(void);
bool ob_setting_is_set(const ob_run_settings *layer, ob_setting_id id);
// Overwrites s with the settings of a layer. A tolerance replaces a number of substeps, and a number of substeps a
// tolerance. gravity does not belong to a layer.
void ob_run_settings_overlay(ob_run_settings *s, const ob_run_settings *layer);

// Resolves the settings of a run: s (a scene's), the requested layer, then the defaults of the architecture. Solvers
// that are wrong by design keep only an explicit tolerance, as more substeps would not help them. lag is 0 unless the
// solver reads it. If ODE's stepper alone would miss the tolerance, it takes more substeps. Returns false and e on a
// setting without meaning for the architecture or the solver.
bool ob_run_settings_resolve(ob_run_settings *s, const ob_run_settings *layer, ob_error *e);

// True if settings from outside are valid for a run: numbers in their ranges, choices among their names. Returns false
// and e, naming the first invalid one.
bool ob_run_settings_check(const ob_run_settings *s, ob_error *e);

// Finds the number of a word in "a|b|c"; false if absent.
bool ob_setting_find(const char *names, const char *word, uint32_t *value);
// Value of a choice or switch, and its word.
typedef struct ob_setting_word {
	char text[16];
} ob_setting_word;
ob_setting_word ob_setting_print(const ob_run_settings *s, ob_setting_id id);

// Words of earlier versions, still accepted in command lines and scenes: the present name of an option, field or choice
// for a former one. NULL: unchanged.
const char *ob_setting_renamed(const char *former);
const char *ob_setting_former(const char *name);

#endif
