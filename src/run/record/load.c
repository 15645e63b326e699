// Records as the program sees them: loads the part that calls HDF5.
#include "record/part.h"

#define PACKAGE "libhdf5-103-1"

static const ob_record_part *load(ob_error *e)
{
	return ob_part_load("hdf5", sizeof(ob_record_part), OB_PART_PROGRAM, PACKAGE, e);
}

static const ob_record_part *part_of(const void *object)
{
	return ((const ob_record_base *)object)->part;
}

bool ob_record_check(ob_error *e)
{
	return ob_part_check("hdf5", PACKAGE, e);
}

ob_recorder *ob_recorder_create(const char *path, const ob_record_facts *facts, ob_error *e)
{
	const ob_record_part *part = load(e);
	ob_recorder *r = part ? part->create(path, facts, e) : NULL;
	if (r)
		((ob_record_base *)r)->part = part;
	return r;
}

bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e)
{
	return part_of(r)->append(r, s, e);
}

bool ob_recorder_sense(ob_recorder *r, const ob_universe *u, ob_error *e)
{
	return part_of(r)->sense(r, u, e);
}

bool ob_recorder_close(ob_recorder *r, ob_error *e)
{
	return !r || part_of(r)->finish(r, e);
}

ob_recording *ob_recording_open(const char *path, ob_error *e)
{
	const ob_record_part *part = load(e);
	ob_recording *r = part ? part->open(path, e) : NULL;
	if (r)
		((ob_record_base *)r)->part = part;
	return r;
}

const ob_recording_info *ob_recording_get_info(const ob_recording *r)
{
	return part_of(r)->info(r);
}

void ob_recording_close(ob_recording *r)
{
	if (r)
		part_of(r)->close(r);
}

bool ob_recording_next(ob_recording *r, bool *ended, ob_error *e)
{
	return part_of(r)->next(r, ended, e);
}

const ob_snapshot *ob_recording_state(const ob_recording *r)
{
	return part_of(r)->state(r);
}

const ob_recorded_sample *ob_recording_samples(const ob_recording *r, size_t *n)
{
	return part_of(r)->samples(r, n);
}

uint64_t ob_recording_population(const ob_recording *r)
{
	return part_of(r)->population(r);
}
