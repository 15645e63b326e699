// The process of an FMU.
#include <stdio.h>

#include "script/foreign.h"
#include "script/foreign_data.h"

_Noreturn void ob_script_serve_foreign(const ob_desk *d, uint32_t number, const void *model, size_t size,
				       ob_foreign_confine *confine, void *with)
{
	ob_foreign_data *data = ob_desk_data(d);
	ob_error e = { "" };
	uint32_t question = ob_desk_seen(d);
	ob_fmu *f = ob_fmu_open(model, size, &e);
	const bool loaded = f && confine(with, &e);
	if (loaded)
		data->loaded = number;
	for (;;) {
		uint32_t done = 0;
		question = ob_desk_next(d, question);
		while (loaded && done < data->turns && done < OB_SCRIPT_BATCH && ob_fmu_run(f, &data->turn[done], &e))
			ob_desk_set_done(d, ++done);
		snprintf(data->why, sizeof data->why, "%.*s", (int)sizeof data->why - 1, e.text);
		ob_desk_answer(d, question);
	}
}
