// The schedule of a free run: in which order simulators stepped, and whose versions each step read. With it the run
// repeats to the bit, in one thread (obsim run --set record_schedule, replay_schedule).
//
//   file   | head: settings, digest of the scene | step | step | step | ... | end |
//                                                   |
//          step: object, version that it publishes, end of the step, numbers of the versions that it read, in the order
//          of reading; its neighbours if it looked for them; whether its simulator began anew (a kill, a birth)
//
// Recording: a worker appends a step just before it publishes the version, by one write. So a step stands behind all
// that it has read. If its simulator is killed between the two, a successor appends the step again, and the last one counts.
//
// Replay: the steps are made one after the other, by one worker. A step may need older versions than the rings keep: the
// worker keeps a version until the last of its readers has had it. A file may hold anything: memory is bounded by its size.
//
// Not repeated: clocks, waits, and the counters of the report. Integers and doubles are this machine's. Thread-safety: a
// schedule belongs to one worker; several append to one file.
#ifndef OB_FREE_SCHEDULE_H
#define OB_FREE_SCHEDULE_H

#include "table/free.h"

typedef struct ob_free_schedule ob_free_schedule;

// A step that is replayed.
typedef struct ob_free_planned_step {
	uint32_t id;
	uint64_t version; // published by the step
	double end; // s
	bool anew; // its simulator begins at the newest version
} ob_free_planned_step;

// ---- the program

// Begins a file. digest: of all else that decides the run. false and e: it cannot be written.
bool ob_free_schedule_create(const char *path, const ob_free_settings *f, uint64_t digest, ob_error *e);
// Ends a file whose run has come to its end.
bool ob_free_schedule_end(const char *path, ob_error *e);
// Checks a whole file, and returns the settings with which it was recorded. false and e, with the place: it is damaged, or
// of another run.
bool ob_free_schedule_check(const char *path, uint64_t digest, ob_free_settings *f, ob_error *e);

// ---- a worker

// Opens the schedule that the run's settings name. *s NULL: none. false and e, without the path: it cannot be read or
// written.
bool ob_free_schedule_open(ob_free_schedule **s, ob_universe *u, ob_error *e);
void ob_free_schedule_close(ob_free_schedule *s); // NULL: nothing
bool ob_free_schedule_replays(const ob_free_schedule *s); // s may be NULL
// False and e: a step could not be written, or does not fit the universe.
bool ob_free_schedule_is_fine(const ob_free_schedule *s, ob_error *e);
// Replay: the next step cannot be made, for it does not fit the universe.
void ob_free_schedule_refuse(ob_free_schedule *s);

// Replay: the next step; it stays the next one until it is taken. false: there are no more.
bool ob_free_schedule_next(const ob_free_schedule *s, ob_free_planned_step *out);
void ob_free_schedule_take(ob_free_schedule *s);

// The simulator's step: reads as ob_free_read does, which it is with s NULL.
uint64_t ob_free_schedule_read(ob_free_schedule *s, const ob_universe *u, uint32_t id, double t, ob_motion *out,
			       ob_motion *next);
// Replay: the neighbours that the step found, if it looked; *n: their number.
bool ob_free_schedule_neighbours(const ob_free_schedule *s, const uint32_t **id, uint32_t *n);
// Recording: notes one more neighbour of the step; the first call, with OB_NO_OBJECT, says that it looked.
void ob_free_schedule_note_neighbour(ob_free_schedule *s, uint32_t id);
// Ends a step of an object, before its version is published: records it, or keeps it for its readers. anew: the simulator has not stepped before. s may be NULL.
void ob_free_schedule_put(ob_free_schedule *s, const ob_universe *u, uint32_t id, const ob_motion *m, bool anew);

#endif
