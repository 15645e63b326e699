// A run as an HDF5 file: all data to draw it again, and trajectories to compute with. docs/records.md describes each
// dataset.
//
//   attributes, /settings, /scene, /cameras, /look    the run, its program, and its look
//   /events [e]                     objects added, changed and removed: a passport each
//   /motions [m], /motions_until [n]   new motions of objects; and their number up to each state
//   /time, /step [n]                the recorded states
//   /position, /attitude, /velocity, /angular_velocity, /asleep [n][ids]   the same as numbers; NaN, 255: no object
//   /sensors [k], /samples [s]         sensors of the scene; their samples
//   /pixels [p]                        pictures of cameras
//   /objects/id, name, shape, size ..  [ids]   the latest object of each id
//
// Each has attributes "units", "frame" and "description". n grows by one with each append, e and m with new entries,
// ids with the highest id so far.
//
// Thread-safety: one thread at a time in the whole process, as HDF5's serial library requires.
#ifndef OB_RECORD_RECORD_H
#define OB_RECORD_RECORD_H

#include "measure/measure.h"
#include "scene/scene.h"

// Facts of a recorded run, beside its states. Needed until the recorder has been created.
typedef struct ob_record_facts {
	ob_universe_info universe; // capacity: initial number of columns
	const ob_scene *scene; // title, text, cameras, look, record_every
	const char *path; // path of its file
	const ob_scene_options *options; // options with which it was read
	const ob_run_settings *settings; // resolved
	double duration; // s
	const char *commit; // commit of the program
} ob_record_facts;

typedef struct ob_recorder ob_recorder;

// True if HDF5 can be loaded; false and e with the package that is missing. Maps nothing.
bool ob_record_check(ob_error *e);
// Creates an HDF5 file, or replaces one. NULL and e on failure. The file is whole after each append: a later reader
// finds all states up to then, even if the process crashes later, or the disk is full. A file without room for the
// first state is removed. If killed during an append, it may be unreadable: after 1 of 60 kills of a writer that did
// nothing else.
ob_recorder *ob_recorder_create(const char *path, const ob_record_facts *facts, ob_error *e);
// Appends a state. false and e: the disk is full, ...
bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e);
// Appends the samples of the scene's sensors that have come since, of those that the universe keeps. While it is paused.
bool ob_recorder_sense(ob_recorder *r, const ob_universe *u, ob_error *e);
bool ob_recorder_close(ob_recorder *r, ob_error *e); // frees r either way; NULL is allowed

#endif
