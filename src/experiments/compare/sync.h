// obsim compare --sync lockstep,free: a scene in lockstep and with free simulators; couplings, isolation, workers, lags; the
// cost and the error of each. An experiment (experiment/) in which a trial is an `obsim run` of its own.
//
// A case is a sweep point, a configuration a row of ob_sync_table. Samples are seeds: a free run differs each time, and a
// scene that draws random numbers does so with each seed. If there are several points, the one nearest to a hundred objects runs all
// configurations, the others those that show how cost and error grow with the number of simulators. Large points get fewer
// seeds if time is short.
#ifndef OB_COMPARE_SYNC_H
#define OB_COMPARE_SYNC_H

#include "experiment/analysis.h"
#include "experiment/experiment.h"

typedef enum ob_sync_coupling {
	OB_SYNC_LOCKSTEP,
	OB_SYNC_GROUP, // solved together, by lockstep's own step
	OB_SYNC_OWN, // neighbours with their mass
	OB_SYNC_HEAVY, // neighbours infinitely heavy
	OB_SYNC_ODE, // as OWN, with ODE's bodies and contact joints
	OB_SYNC_COUPLINGS
} ob_sync_coupling;

typedef struct ob_sync_configuration {
	const char *key, *title; // in files; in tables
	ob_sync_coupling coupling;
	bool processes, each; // each: a worker for each object; else two workers
	double delay; // s after which a publication is seen
	double rate; // Hz, of steps; 0: the comparison's
	bool swept; // runs at each point of a sweep
} ob_sync_configuration;

enum { OB_SYNC_CONFIGURATIONS = 22, OB_SYNC_POINTS = 16, OB_SYNC_DEFINES = 64 };
extern const ob_sync_configuration ob_sync_table[OB_SYNC_CONFIGURATIONS];

typedef enum ob_sync_metric {
	OB_SYNC_CPU, // per body and simulated second
	OB_SYNC_WALL, // per simulated second
	OB_SYNC_UPDATES, // of all simulators per second of wall-clock time
	OB_SYNC_LATENCY, // mean age of what was read
	OB_SYNC_LATENCY_MOST,
	OB_SYNC_WORST,
	OB_SYNC_SIZES, // worst penetration over the bodies' size
	OB_SYNC_ENERGY,
	OB_SYNC_MOMENTUM,
	OB_SYNC_LAG, // lag x speed / size
	OB_SYNC_SHOWN = OB_SYNC_LAG, // from here on for diagrams and files
	OB_SYNC_LOST, // energy that lockstep's run has lost per mass
	OB_SYNC_METRICS
} ob_sync_metric;
extern const ob_metric ob_sync_metrics[OB_SYNC_METRICS];

// The scene with one value of the varied parameter.
typedef struct ob_sync_point {
	char define[128]; // "n=100"; "" = no parameter
	char key[OB_CASE_KEY];
	uint32_t objects; // that move
	uint64_t seed;
	double size, mass; // m, median thickness of what moves; kg, all of it
	uint32_t seeds; // made, after ob_sync_run
	double speed; // m/s: what the energy that lockstep loses is worth; after ob_sync_run
} ob_sync_point;

typedef struct ob_sync_comparison {
	const char *scene; // path
	const char *define[OB_SYNC_DEFINES]; // "name=value" of -D
	uint32_t defines, points;
	uint32_t seeds; // most of a point
	double budget; // s, wall: a point gets no further seed that would not be done by then; three of the main point and one
		// of each other are run in any case
	double duration, rate, jitter; // s, Hz, share: of free runs
	ob_sync_point point[OB_SYNC_POINTS];
	ob_records records; // after ob_sync_run
} ob_sync_comparison;

// Runs the trials that are missing in the folder (NULL: nothing is stored); fresh: all.
bool ob_sync_run(ob_sync_comparison *c, const char *commit, const char *folder, bool fresh, ob_error *e);
void ob_sync_finish(ob_sync_comparison *c);
// Point with all configurations.
const ob_sync_point *ob_sync_main_point(const ob_sync_comparison *c);
// Mean of a metric over seeds, with its interval. n = 0: it was not measured.
ob_estimate ob_sync_estimate(const ob_sync_comparison *c, const ob_sync_point *p, int configuration, ob_sync_metric m);

// Order of a coupling's error in the injected lag, with its interval of 95 %: slope of the worst penetration over the lag,
// both logarithmic. slope NaN: fewer than two lags were run.
ob_line ob_sync_order(const ob_sync_comparison *c, const ob_sync_point *p, ob_sync_coupling coupling);
// True for configurations that differ in the rate alone.
bool ob_sync_is_of_rates(int configuration);
// Order of the error of own responses in the length of a step, without an injected lag.
ob_line ob_sync_order_of_step(const ob_sync_comparison *c, const ob_sync_point *p);

typedef struct ob_sync_text {
	char words[2048];
} ob_sync_text;

enum { OB_SYNC_HYPOTHESES = 3 };
// Judges a hypothesis of the page by the figures of the main point. The first word is the verdict: "Undecided" if intervals
// overlap.
ob_sync_text ob_sync_judge(const ob_sync_comparison *c, int hypothesis);
// Recommendation by rules, from the figures and their intervals alone.
ob_sync_text ob_sync_recommend(const ob_sync_comparison *c, const ob_sync_point *p);

void ob_sync_print(const ob_sync_comparison *c, FILE *f, size_t width);
// Writes report.html and plots/, beside the records in results.csv.
bool ob_sync_write_folder(const ob_sync_comparison *c, const char *folder, ob_error *e);

#endif
