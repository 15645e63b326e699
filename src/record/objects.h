// Inside the module record only: the group /objects, what the recorded objects are.
#ifndef OB_RECORD_OBJECTS_H
#define OB_RECORD_OBJECTS_H

#include "measure/measure.h"
#include "record/file.h"

enum { OB_RECORD_FACTS = 10 };

typedef struct ob_record_objects {
	uint32_t count;
	hid_t group, set[OB_RECORD_FACTS]; // negative: not there
	ob_passport *written; // [count]
} ob_record_objects;

// o starts zeroed. false on failure; finish is due either way.
bool ob_record_objects_create(ob_record_objects *o, hid_t file, uint32_t count);
// Enters passports that are new or have changed.
bool ob_record_objects_update(ob_record_objects *o, const ob_snapshot *s);
bool ob_record_objects_finish(ob_record_objects *o);

#endif
