// Reader of a record (record.h), state by state, for `obsim run --replay`, `obsim serve --replay` and `obsim export`.
//
//   open ──> a child opens the file, reads some seconds of it, and checks it       one line explains an error
//     └────> next, next, ..    the first state, the second ..    snapshots, as they were recorded, or the line
//              └──> after the last state that the child has read, the child reads on
//
// A file from outside may hold anything, and HDF5 is not safe against all of it. So a child process reads it first,
// whose death is one more sign that the file is damaged. Then each id, count and number is checked against its range.
// Opening costs the child 5 s of CPU at most, whatever the file, and this process no more than the child. A record that
// can be read in 2 s is read to its end then. Drawings of a snapshot equal those of the run to the bit.
//
// Thread-safety: one thread at a time in the whole process, as HDF5's serial library has it. open forks, and the
// child dies with the thread that called it.
#ifndef OB_RECORD_RECORDING_H
#define OB_RECORD_RECORDING_H

#include "measure/measure.h"
#include "scene/scene.h"

typedef struct ob_recording ob_recording;

typedef struct ob_recording_info {
	ob_scene
		scene; // title, gravity, step length, duration, seed, cameras, look, sensors, record_every; no objects, no text
	char universe[OB_NAME_MAX], isolation[16], version[32], commit[64], created[32];
	uint32_t workers;
	uint64_t states; // recorded, at least 1
	double interval; // s, between two states
	uint64_t first; // intervals from the run's start to the first
	double begin, end; // s, of the first and of the last
} ob_recording_info;

// NULL and e, which begins with the path: unreadable, not a record, of another version, truncated or damaged.
ob_recording *ob_recording_open(const char *path, ob_error *e);
const ob_recording_info *ob_recording_get_info(const ob_recording *r);
void ob_recording_close(ob_recording *r); // NULL is allowed

// Goes to the next state, from the start to the first. false at the end, or, with e, on a read error; *ended tells them
// apart.
bool ob_recording_next(ob_recording *r, bool *ended, ob_error *e);
// Current state. step counts intervals from the run's start; there are no contacts. Valid until the next call of
// ob_recording_next.
const ob_snapshot *ob_recording_state(const ob_recording *r);
// A sample of a sensor of the scene (info.scene.sensor), with as many values as the sensor's width: as of
// ob_universe_get_samples.
typedef struct ob_recorded_sample {
	uint32_t sensor;
	uint64_t number;
	double time; // s
	const double *value;
} ob_recorded_sample;
// Samples since the state before, by this state's time; n of them. Likewise valid.
const ob_recorded_sample *ob_recording_samples(const ob_recording *r, size_t *n);
// Grows with each state in which an object was added, removed or changed.
uint64_t ob_recording_population(const ob_recording *r);

#endif
