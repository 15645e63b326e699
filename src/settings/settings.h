// The settings of a run: how it is stepped and solved. One record for scene files, the command line, the host, the
// shared table, the engines and reports, and one description of its members: names, units, ranges.
//
// A layer of settings, as a scene or a command line gives them, is the same record with the members that it leaves
// alone unset. Pure; any thread.
#ifndef OB_SETTINGS_SETTINGS_H
#define OB_SETTINGS_SETTINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>
#include <ob/vec.h>

typedef enum ob_solver_kind {
	OB_SOLVER_COLOURED, // contact after contact, each on what the one before published
	OB_SOLVER_JACOBI,   // all contacts on the same state, masses split between the contacts of a body
	OB_SOLVER_GHOST,    // each takes its neighbours for infinitely heavy: what must not be done, to show it
	OB_SOLVER_LAGGED,   // each computes the contact's impulse for itself, on a state of its partner that is late
} ob_solver_kind;

typedef enum ob_integrator {
	OB_INTEGRATOR_EXACT, // free motion in closed form
	OB_INTEGRATOR_ODE,   // by ODE's stepper
} ob_integrator;

typedef enum ob_narrow_phase {
	OB_NARROW_OBB,  // objects touch where their shapes do, however they are turned
	OB_NARROW_AABB, // objects touch where the axis-aligned boxes that hold them overlap
} ob_narrow_phase;

// The names of the values of an enum or a switch, in the order of their numbers.
#define OB_ARCHITECTURE_NAMES "obs|monolith"
#define OB_SOLVER_NAMES "coloured|jacobi|ghost|lagged"
#define OB_INTEGRATOR_NAMES "exact|ode"
#define OB_NARROW_PHASE_NAMES "obb|aabb"
#define OB_SWITCH_NAMES "off|on"

// Faults that are injected into a run, to see how it survives them (--fault).
typedef enum ob_fault_kind {
	OB_FAULT_KILL, // a simulator's process kills itself
	OB_FAULT_SEGV, // .. reads where there is nothing
	OB_FAULT_EXIT, // .. leaves in the middle of its work
	OB_FAULT_STOP, // .. stops (SIGSTOP) and does nothing any more
	OB_FAULT_SLOW, // a simulator sleeps
	OB_FAULT_SCRIBBLE, // .. stores random words anywhere in the universe where it can write
	OB_FAULT_NOSPACE, // a checkpoint cannot be written, as on a full disk
	OB_FAULT_NOPAGES, // the universe cannot grow, as in a full /dev/shm
	OB_FAULT_ABORT, // a simulator's process says why on standard error, and aborts, as an assertion does
	OB_FAULT_KINDS
} ob_fault_kind;
#define OB_FAULT_NAMES "kill|segv|exit|stop|slow|scribble|nospace|nopages|abort"

// A simulator has a chance to fail after each island that it has solved, at the end of each phase, and when it has
// scheduled the next. Whether it does is drawn from the seed, its worker's number, how often all were restarted, and how many
// chances it has had since.
typedef struct ob_fault_plan {
	double probability; // at each chance; 0 = no faults
	uint64_t seed;
	uint32_t kinds; // bits, 1 << ob_fault_kind: one of them is drawn
	uint32_t words; // SCRIBBLE: so many
	uint32_t sleep_ms; // SLOW: for so long
	uint32_t zero;
} ob_fault_plan;

// Draws what happens at a chance (from 0) of a worker; OB_FAULT_KINDS: nothing. among: the kinds that can happen there.
// random: for more draws.
ob_fault_kind ob_fault_draw(const ob_fault_plan *p, uint32_t among, uint32_t worker, uint64_t chance, uint64_t *random);

// What is done so that a simulator's process harms nobody but itself (--harden; host/confine.h has what each is).
typedef enum ob_harden_measure {
	OB_HARDEN_OUTBOX, // it hands over its results, which the arranger checks and writes (table/outbox.h)
	OB_HARDEN_CHECKSUM, // what it hands over bears a checksum; needs OUTBOX
	OB_HARDEN_PAGES, // it maps the universe read-only, but for its own outbox; needs OUTBOX
	OB_HARDEN_PRIVILEGES, // it has no root, no capabilities
	OB_HARDEN_LIMITS, // of resources
	OB_HARDEN_CALLS, // of the system's, few may be made
	OB_HARDEN_MEASURES
} ob_harden_measure;
#define OB_HARDEN_NAMES "outbox|checksum|pages|privileges|limits|calls"
enum { OB_HARDEN_ALL = (1 << OB_HARDEN_MEASURES) - 1 }; // bits, 1 << ob_harden_measure

// The measures of a list as "pages,calls", and those that these need; "": all, NULL: none. false and e: a word is none of them.
bool ob_harden_read(uint32_t *measures, const char *list, ob_error *e);

// Fixed for a run; lies in the table, so that every process sees the same: a fixed size, no pointers.
typedef struct ob_run_settings {
	ob_vec3 gravity;         // m/s^2
	double step_length;      // s
	double tolerance;        // m; > 0: each island chooses its substeps so that its error stays below
	uint32_t substeps;       // per step, >= 1; with a tolerance: at least
	uint32_t iterations;     // of the contact solver per substep, at most; of a monolith: QuickStep's, 0 = exact solver
	uint32_t solver;         // ob_solver_kind
	uint32_t lag;            // OB_SOLVER_LAGGED: iterations that a partner's state is late
	uint32_t integrator;     // ob_integrator
	uint32_t narrow_phase;   // ob_narrow_phase
	uint32_t sleeping;       // 1 = islands may fall asleep
	uint32_t monolith;       // 1 = one ODE world holds all objects
	uint32_t one_per_object; // 1 = worker i runs object i and nothing else; set by the host
	uint32_t timed;          // 1 = counters tell what each section of the step took
	uint32_t load;           // > 0: 1 + 2 + .. + load is added up at each test of two axis-aligned boxes
	uint32_t freezes;        // 1 = what cannot be solved is frozen: budgets are each island's own; set by the host
	ob_fault_plan fault;
} ob_run_settings;

// What thresholds that have a unit are multiplied by: 1 at the default tolerance, or without one. So a run whose lengths,
// tolerance, and times (as the square root of lengths: gravity stays) are all scaled goes on as before.
typedef struct ob_units {
	double length, time, speed;
} ob_units;
ob_units ob_run_settings_units(const ob_run_settings *s);

// Defaults. A tolerance that is asked for chooses the substeps from ob_run_settings_least_substeps() up.
#define OB_DEFAULT_STEP (1. / 60) // s
#define OB_DEFAULT_TOLERANCE 1e-3 // m
enum {
	OB_DEFAULT_SUBSTEPS = 8,
	OB_DEFAULT_ITERATIONS = 16, // object simulators
	OB_DEFAULT_TOLERANCE_ITERATIONS = 64, // object simulators whose tolerance was asked for
	OB_DEFAULT_MONOLITH_ITERATIONS = 20, // ODE's own default
};

// The most substeps that a tolerance chooses.
#define OB_MAX_SUBSTEPS 1024

// The fewest substeps that a tolerance (m) chooses from: 8, and fewer only where it is coarser than the default. What a
// solution errs by is not all of it seen (a pivot's energy, a slow creep): a smaller tolerance never starts from less.
uint32_t ob_run_settings_least_substeps(double tolerance);

// By how much coarser than the default a run is that has a tolerance: its substeps are at least so many times as long;
// 1 at the default, at any smaller tolerance, and without one. It has no unit, so that it stays where a run is rescaled.
double ob_run_settings_coarseness(const ob_run_settings *s);

// Coloured solver, exact integrator, 8 substeps at least with the default tolerance, sleeping.
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
	OB_SETTING_REAL,   // double, in its unit
	OB_SETTING_COUNT,  // uint32_t
	OB_SETTING_CHOICE, // uint32_t, a number among names
	OB_SETTING_SWITCH, // uint32_t, 0 or 1; in a scene true or false
} ob_setting_kind;

typedef struct ob_setting {
	const char *name;   // of the option, the scene's field and the report's key
	ob_setting_kind kind;
	size_t offset;      // in ob_run_settings
	double least, most; // of numbers
	bool above;         // least itself is too small
	const char *unit;   // "" = none
	const char *names;  // CHOICE, SWITCH: "a|b|c"
} ob_setting;

extern const ob_setting ob_setting_table[OB_SETTINGS];

// A layer in which nothing is set.
ob_run_settings ob_run_settings_unset(void);
bool ob_setting_is_set(const ob_run_settings *layer, ob_setting_id id);
// Lays over s what is set in layer. A tolerance replaces a number of substeps, and a number of substeps a tolerance.
// gravity is no part of a layer.
void ob_run_settings_overlay(ob_run_settings *s, const ob_run_settings *layer);

// The settings of a run: s (a scene's) with the layer that was asked for, after the defaults of the architecture.
// Solvers that are wrong by design keep no tolerance unless asked to, for more substeps would not mend them; lag is 0
// unless the solver reads it; where ODE's stepper alone would miss the tolerance, it takes more substeps.
// false and e: a setting means nothing to the architecture or to the solver.
bool ob_run_settings_resolve(ob_run_settings *s, const ob_run_settings *layer, ob_error *e);

// Whether settings that came from outside could be those of a run: numbers in their ranges, choices among their names.
// false and e names the one that could not.
bool ob_run_settings_check(const ob_run_settings *s, ob_error *e);

// The number of a word in "a|b|c"; false: it is none of them.
bool ob_setting_find(const char *names, const char *word, uint32_t *value);
// The word of a choice or switch.
typedef struct ob_setting_word {
	char text[16];
} ob_setting_word;
ob_setting_word ob_setting_print(const ob_run_settings *s, ob_setting_id id);

// Words of earlier versions, which command lines and scenes may still use: what an option, a field or a choice is called
// now, and what it was called before. NULL: it has not changed.
const char *ob_setting_renamed(const char *former);
const char *ob_setting_former(const char *name);

#endif
