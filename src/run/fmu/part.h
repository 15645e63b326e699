// The part of obsim that reads FMUs (base/part.h): obsim-fmu.so.
#ifndef OB_FMU_PART_H
#define OB_FMU_PART_H

#include "base/part.h"
#include "fmu/archive.h"

typedef struct ob_fmu_part {
	ob_part_head head;
	bool (*read)(const unsigned char *bytes, size_t size, ob_fmu_file *out, ob_error *e); // into zeroes
} ob_fmu_part;

#endif
