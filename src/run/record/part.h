// The part of obsim that calls HDF5 (base/part.h): obsim-hdf5.so. Its functions are those of record.h and recording.h.
#ifndef OB_RECORD_PART_H
#define OB_RECORD_PART_H

#include "base/part.h"
#include "record/record.h"
#include "record/recording.h"

ob_recorder *ob_hdf5_recorder_create(const char *path, const ob_record_facts *facts, ob_error *e);
bool ob_hdf5_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e);
bool ob_hdf5_recorder_sense(ob_recorder *r, const ob_universe *u, ob_error *e);
bool ob_hdf5_recorder_close(ob_recorder *r, ob_error *e);
ob_recording *ob_hdf5_recording_open(const char *path, ob_error *e);
const ob_recording_info *ob_hdf5_recording_get_info(const ob_recording *r);
void ob_hdf5_recording_close(ob_recording *r);
bool ob_hdf5_recording_next(ob_recording *r, bool *ended, ob_error *e);
const ob_snapshot *ob_hdf5_recording_state(const ob_recording *r);
const ob_recorded_sample *ob_hdf5_recording_samples(const ob_recording *r, size_t *n);
uint64_t ob_hdf5_recording_population(const ob_recording *r);

typedef struct ob_record_part {
	ob_part_head head;
	ob_recorder *(*create)(const char *path, const ob_record_facts *facts, ob_error *e);
	bool (*append)(ob_recorder *r, const ob_snapshot *s, ob_error *e);
	bool (*sense)(ob_recorder *r, const ob_universe *u, ob_error *e);
	bool (*finish)(ob_recorder *r, ob_error *e);
	ob_recording *(*open)(const char *path, ob_error *e);
	const ob_recording_info *(*info)(const ob_recording *r);
	void (*close)(ob_recording *r);
	bool (*next)(ob_recording *r, bool *ended, ob_error *e);
	const ob_snapshot *(*state)(const ob_recording *r);
	const ob_recorded_sample *(*samples)(const ob_recording *r, size_t *n);
	uint64_t (*population)(const ob_recording *r);
} ob_record_part;

// First member of each recorder and recording.
typedef struct ob_record_base {
	const ob_record_part *part;
} ob_record_base;

#endif
