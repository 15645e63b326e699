// A record (record.h), read back state by state: what `obsim run --replay`, `obsim serve --replay` and `obsim export`
// show.
//
//   open ──> the file is read to its end once, by a child, and checked      one line says what is wrong with it
//     └────> next, next, ..    the first state, the second ..               snapshots, as those that were recorded
//
// A file from outside may hold anything, and HDF5 is not safe from each: it is first read by a process of its own,
// whose death is one more way to say that the file is damaged. Then each id, count and number is checked against what
// it can be. What is drawn of a snapshot is to the bit what was drawn of the run.
//
// Thread-safety: one thread at a time in the whole process, as HDF5's serial library has it. open forks.
#ifndef OB_RECORD_RECORDING_H
#define OB_RECORD_RECORDING_H

#include "measure/measure.h"
#include "scene/scene.h"

typedef struct ob_recording ob_recording;

typedef struct ob_recording_info {
	ob_scene scene; // title, gravity, step length, duration, seed, cameras, look, record_every; no objects, no text
	char universe[OB_NAME_MAX], isolation[16], version[32], commit[64], created[32];
	uint32_t workers;
	uint64_t states; // recorded, 1 at least
	double interval; // s, between two
	uint64_t first; // intervals from the run's start to the first
	double begin, end; // s, of the first and of the last
} ob_recording_info;

// NULL and e, which begins with the path: it cannot be read, is no record, of another version, cut short or damaged.
ob_recording *ob_recording_open(const char *path, ob_error *e);
const ob_recording_info *ob_recording_get_info(const ob_recording *r);
void ob_recording_close(ob_recording *r); // NULL is allowed

// Goes on to the next state, at first to the first; false where there is none, and, with e, where it cannot be read.
// *ended says which.
bool ob_recording_next(ob_recording *r, bool *ended, ob_error *e);
// The state that it has come to. step counts intervals from the run's start; there are no contacts. Holds until the
// next.
const ob_snapshot *ob_recording_state(const ob_recording *r);
// Grows with each state in which somebody came, went, or became something else.
uint64_t ob_recording_population(const ob_recording *r);

#endif
