// Trajectories to HDF5.
//
// One file, one group of facts and one dataset a quantity; n grows by one with each append:
//
//   /time [n]  /step [n]                              s, 1
//   /position [n][objects][3]                         m, centre of mass, world frame
//   /attitude [n][objects][4]                         unit quaternion w x y z, body to world
//   /velocity, /angular_velocity [n][objects][3]      m/s, rad/s, world frame
//   /asleep [n][objects]                              1 = asleep, 255 = no such object then
//   /objects/id, name, shape, size, mass, inertia, friction, restitution, static, generation [objects]
//
// Each has attributes "units", "frame" and "description"; the file has "obsim_version", "title", "universe", "arch",
// "isolation", "gravity", "step_length", "workers". The second index is the object's id; where there is no object, NaN.
//
// Thread-safety: one thread at a time in the whole process, as HDF5's serial library has it.
#ifndef OB_RECORD_RECORD_H
#define OB_RECORD_RECORD_H

#include "measure/measure.h"

typedef struct ob_recorder ob_recorder;
// Creates an HDF5 file, or replaces one, with a column for each of ids 0 .. info->capacity - 1; others must stay absent.
// NULL and e on failure. The file is whole after each append: a later reader finds all states up to then, also when the
// process crashes later, and when the disk is full. Killed in the midst of an append it may be unreadable: 1 of 60 kills
// of a writer that did nothing else.
ob_recorder *ob_recorder_create(const char *path, const ob_universe_info *info, const char *scene_title, ob_error *e);
// One more state. Objects that appear or are replaced are entered in /objects. false and e: the disk is full, ...
bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e);
bool ob_recorder_close(ob_recorder *r, ob_error *e); // frees r either way; NULL is allowed

#endif
