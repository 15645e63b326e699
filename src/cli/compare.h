// A comparison: the ways to run one scene, run often and by turns, and what came of each.
#ifndef OB_CLI_COMPARE_H
#define OB_CLI_COMPARE_H

#include "cli/options.h"
#include "cli/report.h"
#include "reference/statistics.h"

typedef enum ob_crowd { OB_CROWD_ONE, OB_CROWD_TWO, OB_CROWD_POOL, OB_CROWD_GROUPS, OB_CROWD_EACH } ob_crowd;
enum { OB_GROUP = 60 }; // objects of a worker in groups

typedef struct ob_way {
	const char *key; // in JSON and CSV
	const char *title; // in tables
	const char *arch, *isolation;
	ob_crowd crowd; // of workers
	uint32_t objects_max; // with more objects it is not tried; 0 = any number
	bool other_narrow; // runs with the narrow phase that was not asked for
} ob_way;

typedef enum ob_way_id {
	OB_WAY_MONOLITH,
	OB_WAY_THREAD,
	OB_WAY_THREADS_2,
	OB_WAY_THREADS,
	OB_WAY_PROCESSES,
	OB_WAY_GROUPS,
	OB_WAY_THREADS_EACH,
	OB_WAY_PROCESSES_EACH,
	OB_WAY_MONOLITH_OTHER, // from here on: the other narrow phase
	OB_WAY_THREADS_OTHER,
	OB_WAYS
} ob_way_id;
extern const ob_way ob_way_table[OB_WAYS];

typedef enum ob_way_state { OB_WAY_SKIPPED, OB_WAY_DONE, OB_WAY_FAILED } ob_way_state;
enum { OB_REPEATS_MAX = 99, OB_SECTIONS_MAX = 16 };

typedef struct ob_cell {
	ob_way_state state;
	char why[256]; // unless done
	uint32_t workers;
	uint32_t samples;
	ob_report *sample; // [repeats]
} ob_cell;

// All ways with one value of what is varied.
typedef struct ob_section {
	char define[128]; // "n=100"; "" = nothing is varied
	uint32_t objects;
	ob_cell cell[OB_WAYS];
	bool measured_differs; // object simulators that were looked at each step ended in other bits
} ob_section;

typedef struct ob_comparison {
	const char *scene;
	const char *narrow, *other; // narrow phases
	uint64_t load;
	uint32_t repeats, pool;
	double took_s;
	char machine[192], options[512]; // as the command line had them
	uint32_t sections;
	ob_section section[OB_SECTIONS_MAX];
} ob_comparison;

// ---- what is run (compare_plan.c)

// One section for each value of "n=100,1000"; NULL makes one section in which nothing is varied.
bool ob_comparison_read_sections(ob_comparison *c, const char *vary, ob_error *e);
// Marks the ways that s->objects allow as done, makes room for their samples, and says why others are left out.
// false: no memory.
bool ob_section_plan(ob_section *s, const ob_comparison *c);

// ---- figures (compare_figures.c)

typedef enum ob_figure {
	OB_FIGURE_COST, // CPU per body and step
	OB_FIGURE_WALL,
	OB_FIGURE_CPU,
	OB_FIGURE_P50,
	OB_FIGURE_P90,
	OB_FIGURE_P99,
	OB_FIGURE_MAX,
	OB_FIGURE_CRITICAL,
	OB_FIGURE_WORK,
	OB_FIGURE_GATE,
	OB_FIGURE_GATE_CPU,
	OB_FIGURE_HELD,
	OB_FIGURE_EXPLAINED,
	OB_FIGURE_PER_SIMULATOR,
	OB_FIGURE_HOST,
	OB_FIGURE_RENDERER,
	OB_FIGURE_FPS,
	OB_FIGURE_SWITCHES,
	OB_FIGURE_STARTUP,
	OB_FIGURE_STARTUP_EACH,
	OB_FIGURE_MEMORY,
	OB_FIGURE_MEMORY_EACH,
	OB_FIGURE_MEMORY_WORKER,
	OB_FIGURE_PENETRATION,
	OB_FIGURE_WORST,
	OB_FIGURE_SEPARATION,
	OB_FIGURE_ENERGY,
	OB_FIGURE_MOMENTUM,
	OB_FIGURE_KINDS
} ob_figure;

typedef struct ob_figure_info {
	const char *key, *title;
	const char *unit; // "" = a bare ratio
	const char *group; // heading; NULL = under the one before
	const char *meaning;
} ob_figure_info;
extern const ob_figure_info ob_figure_table[OB_FIGURE_KINDS];

double ob_figure_of(const ob_report *r, ob_figure f); // NaN: not measured
// Of all samples; least to most if there are too few for an interval.
typedef struct ob_spread {
	double median, low, high;
	size_t n;
} ob_spread;
ob_spread ob_spread_of(const ob_cell *c, ob_figure f);
// Sample by sample, one way's figure over another's: what changes from one repeat to the next cancels out.
ob_spread ob_ratio_of(const ob_cell *of, const ob_cell *to, ob_figure f);

// ---- what follows from it

// true when all object simulators of a narrow phase ended in the same bits
bool ob_section_agrees(const ob_section *s);
bool ob_cell_is_done(const ob_section *s, ob_way_id way);

// What a section shows, by rules. headline: "Thread or process?" in a few words; answer: with its figures.
typedef struct ob_verdict {
	char headline[160], answer[768], architecture[512], narrow[768], sum[512];
} ob_verdict;
void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_section *s);

void ob_comparison_print(const ob_comparison *c, FILE *f);
void ob_comparison_write_json(const ob_comparison *c, FILE *f);
void ob_comparison_write_csv(const ob_comparison *c, FILE *f);
// report.html, results.csv, results.json and plots/ in a folder, which is made.
bool ob_comparison_write_folder(const ob_comparison *c, const char *folder, ob_error *e);

#endif
