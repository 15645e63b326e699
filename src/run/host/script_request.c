#include "host/script_request.h"

#include <stdio.h>
#include <string.h>

#include "host/request_table.h"

bool ob_script_request_read(const ob_script_post *post, ob_request *r)
{
	const void *const contents = post + 1;
	const ob_script_path *path = contents;
	const uint32_t numbers = post->used / sizeof(double);
	ob_request_begin(r, ob_request_row_of(post->kind));
	r->id = post->object, r->generation = post->generation;
	if (r->kind != OB_REQUEST_PATH)
		return post->used == numbers * sizeof(double) &&
		       ob_request_put_numbers(r, contents, numbers) == numbers;
	const size_t bytes = post->used - sizeof *path;
	if (post->used < sizeof *path || bytes > sizeof r->path.point)
		return false;
	r->path.points = (uint32_t)(bytes / sizeof *path->point);
	r->path.loop = path->loop, r->path.turns = path->turns;
	memcpy(r->path.point, path->point, bytes);
	return true;
}

void ob_script_request_refuse(ob_universe *u, uint32_t cell, uint32_t line, const char *why)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_script_turn *turn = &data->script_turn[cell];
	ob_script_cell *c = &data->script_cell[cell];
	const uint32_t script = turn->script - 1;
	turn->flags |= OB_SCRIPT_STOPPED;
	c->failed_step = (uint32_t)ob_step_count(u);
	snprintf(c->error, sizeof c->error, "%.47s:%u: %.130s",
		 script < data->script_text->scripts ? data->script_text->text[script].name : "?", line, why);
	data->script_counts->failed++;
	data->script_counts->stopped++;
}
