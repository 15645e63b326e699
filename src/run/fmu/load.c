#include <stdlib.h>

#include "fmu/part.h"

bool ob_fmu_read(const unsigned char *bytes, size_t size, ob_fmu_file *out, ob_error *e)
{
	const ob_fmu_part *part = ob_part_load("fmu", sizeof *part, OB_PART_PROGRAM, "libzip4 and libexpat1", e);
	*out = (ob_fmu_file){ .standard = 0 };
	if (part && part->read(bytes, size, out, e))
		return true;
	ob_fmu_finish(out);
	return false;
}

void ob_fmu_finish(ob_fmu_file *f)
{
	for (uint32_t i = 0; i < f->variables; i++)
		free(f->variable[i].name);
	free(f->variable);
	free(f->library);
	*f = (ob_fmu_file){ .standard = 0 };
}
