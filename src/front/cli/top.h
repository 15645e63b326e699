// Sample of a universe at one instant with the rates since the one before, and its lines of text.
#ifndef OB_CLI_TOP_H
#define OB_CLI_TOP_H

#include <stdio.h>

#include <ob/sensor.h>
#include <ob/universe.h>

// The host refreshes a worker's CPU time about twice a second, at instants of its own. So a rate is taken between
// two refreshes that were seen, not between two looks.
typedef struct ob_top_worker {
	ob_worker_info info;
	uint64_t mark_ns; // CPU time at the refresh from which the rate is taken
	double mark_at; // s, wall clock, when that was seen
	double seen_at; // s, when the newest refresh was seen; 0 = none yet
	double share; // CPU per wall; NaN = not known yet
} ob_top_worker;

typedef struct ob_top_object {
	uint32_t id;
	bool moving; // has a motion that makes sense
	bool housed; // in a worker, "home"
	uint32_t home;
	bool waits; // in a free run: its simulator waits for that of object "blocker"
	uint32_t blocker;
	ob_passport passport;
	ob_motion motion;
	ob_vec3 position; // m, at the universe's time
	double speed, spin; // m/s, rad/s
} ob_top_object;

typedef struct ob_top_sensor {
	ob_sensor_passport passport;
	uint64_t number; // its newest sample; 0: none can be read yet
	double time; // s
	double value[6]; // the first ones, or the shortest range of a lidar; none of a camera
} ob_top_sensor;

typedef struct ob_top_sample {
	ob_universe_info info;
	bool alive; // its host still runs
	double at; // s, wall clock of this look; 0 = none yet
	double steps_per_second, pace; // NaN = not known yet; pace: simulated per wall second
	uint32_t workers, objects, sensors;
	ob_top_worker *worker;
	ob_top_object *object;
	ob_top_sensor *sensor;
	uint32_t worker_room, object_room, sensor_room;
} ob_top_sample;

// Only the workers' clocks: call it some times between two looks, so that refreshes are seen when they come.
void ob_top_watch(ob_top_sample *s, const ob_universe *u);
// A whole look. s starts zeroed. false: out of memory.
bool ob_top_look(ob_top_sample *s, const ob_universe *u);
void ob_top_finish(ob_top_sample *s);

typedef struct ob_top_view {
	int columns, lines; // of the screen; lines 0 = as many as it takes
	bool workers, sensors; // show the workers, or the sensors, at length, else the objects
	bool by_speed; // fastest objects first, else by id
	uint32_t scroll; // first record shown
	int written; // lines, of this look
} ob_top_view;

// Sorts s's objects as the view wants them, brings scroll into range, and writes at most view->lines lines, each with
// a final newline, none wider than view->columns. Text from the universe is made harmless to a terminal.
void ob_top_view_write(ob_top_view *view, ob_top_sample *s, FILE *f);

#endif
