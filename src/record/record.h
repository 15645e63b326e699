// Trajectories to HDF5, summaries to CSV.
#ifndef OB_RECORD_RECORD_H
#define OB_RECORD_RECORD_H

#include "measure/measure.h"

typedef struct ob_recorder ob_recorder;
// Creates an HDF5 file. What is written is readable after every append + flush (also after Ctrl-C).
ob_recorder *ob_recorder_create(const char *path, const ob_universe_info *info, const char *scene_title, ob_error *e);
bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e);
bool ob_recorder_close(ob_recorder *r, ob_error *e); // frees r either way

#endif
