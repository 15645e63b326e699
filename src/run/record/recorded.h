// Inside the module record only: a recording, shared by its files: recording.c goes from state to state, recorded_list.c reads
// datasets, recorded_samples.c samples of sensors.
#ifndef OB_RECORD_RECORDED_H
#define OB_RECORD_RECORDED_H

#include "record/layout.h"
#include "record/part.h"

// A dataset of compounds, read in blocks.
typedef struct ob_recorded_list {
	const ob_record_table *table;
	hid_t set, type; // negative: missing
	uint64_t total, first, held; // total: in the dataset; first, held: the block in memory
	uint64_t room; // largest block
	char *item; // [held], of table->size
} ob_recorded_list;

// The process that reads the record before this one does.
typedef struct ob_recording_reader {
	pid_t pid; // 0: none
	int link; // socket to it
	uint64_t states; // read by it so far; UINT64_MAX: all
} ob_recording_reader;

struct ob_recording {
	ob_record_base base;
	ob_recording_reader first;
	char *path; // for messages: the file is read through its descriptor
	hid_t file; // negative: missing
	uint64_t file_bytes;
	ob_recording_info info;
	double *time; // [states]
	uint64_t *step, *motions_until; // [states]
	ob_recorded_list events, motions, joints; // joints: empty in a record older than they are
	ob_recorded_list samples, pixels; // likewise
	uint64_t state; // current state; UINT64_MAX: none yet
	uint64_t event, motion, joint, sample; // first ones of a later state
	ob_snapshot now;
	uint64_t population;
	ob_recorded_sample *recent; // [recents]: since the state before
	size_t recents, recents_max;
	double *value; // [values]: theirs
	size_t values, values_max;
};

// Says that the record is damaged, and where. Returns false.
bool ob_recording_damaged(const ob_recording *r, const char *what, ob_error *e);

// ---- recorded_list.c

// Looks up a name of groups and their members, link by link. false and e: one of the links leaves the file.
bool ob_recording_find(const ob_recording *r, const char *name, bool *there, ob_error *e);
// Opens a dataset of the file itself with this rank, all on the disk. Negative and e: there is none.
hid_t ob_recorded_set_open(const ob_recording *r, const char *name, H5T_class_t kind, int rank, uint64_t *count,
			   ob_error *e);
// A list that is not open, but may be closed.
ob_recorded_list ob_recorded_list_of(const ob_record_table *table);
bool ob_recorded_list_open(ob_recording *r, ob_recorded_list *l, ob_error *e);
void ob_recorded_list_close(ob_recorded_list *l);
// Returns item i < total, until the next call; NULL: it cannot be read.
const void *ob_recorded_item(ob_recorded_list *l, uint64_t i);

// ---- recorded_samples.c

// Opens the scene's sensors and their samples, if there are any.
bool ob_recorded_samples_open(ob_recording *r, ob_error *e);
// Reads the samples of the current state.
bool ob_recorded_samples_take(ob_recording *r, ob_error *e);
void ob_recorded_samples_close(ob_recording *r);

#endif
