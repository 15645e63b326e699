// What is run, and what one run measures.
#ifndef OB_PAPER_SAMPLE_H
#define OB_PAPER_SAMPLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum ob_paper_scenario {
	OB_PAPER_COMMON, // the paper's scenario 1
	OB_PAPER_COMMON_LOAD, // with the added work
	OB_PAPER_OBS, // the paper's scenario 2
	OB_PAPER_OBS_LOAD, // from here on: what the paper never ran
	OB_PAPER_OBS_OBB,
	OB_PAPER_COMMON_OBB,
	OB_PAPER_POOL,
	OB_PAPER_SCENARIOS
} ob_paper_scenario;

typedef struct ob_paper_setup {
	const char *key, *title; // in files; for people
	const char *what; // how it is run
	bool monolith, each; // one world; one process per object, else (of OBS) a pool of threads
	bool oriented; // true shapes, else axis-aligned boxes
	uint32_t load; // numbers added up in each test of two boxes
} ob_paper_setup;

extern const ob_paper_setup ob_paper_setups[OB_PAPER_SCENARIOS];

// One experiment in one scenario. What was not measured is NaN.
typedef struct ob_paper_sample {
	ob_paper_scenario scenario;
	bool growth; // of the series with more and more objects, else of the experiments
	uint32_t experiment; // from 0
	uint32_t objects;
	uint64_t seed;
	char failed[160]; // "" = it ran
	double step_s; // wall time of a step: until the last simulator is done
	double total_s; // CPU of all simulators in a step
	double one_s; // the same divided by the number of simulators
	double busiest_s; // CPU of the busiest worker in a step
	double cpu; // CPU of all simulators by wall time: 1 = one core
	double demand; // by simulated time
	double pace; // simulated time by wall time: 1 = as fast as reality, which is the most
	double fps; // frames that were really drawn, by wall time
	double viewer_cpu; // CPU of the viewer and the host by wall time, while frames are drawn
	double box_tests; // in a step
	double memory_bytes;
} ob_paper_sample;

typedef struct ob_paper_results {
	char machine[192], commit[64];
	char no_frames[200]; // why none were drawn; "" = they were
	uint32_t objects, experiments; // as planned
	double busy; // load average of the machine before the first run: 1 = something else kept one core busy
	double sum_s; // CPU time of adding up 1 to 1000 by itself
	size_t count, room;
	ob_paper_sample *sample;
} ob_paper_results;

// A sample of which nothing is known yet
ob_paper_sample ob_paper_sample_unmeasured(void);
bool ob_paper_results_add(ob_paper_results *r, const ob_paper_sample *s); // false: no memory
void ob_paper_results_finish(ob_paper_results *r);

// The three tables that the paper prints of its own runs (Elfizar et al.): runtime as step_s, frame rate, CPU. The
// caller finishes it. Empty if there is no memory.
ob_paper_results ob_paper_published(void);

#endif
