#include "host/script_request.h"

#include <stdio.h>
#include <string.h>

bool ob_script_request_read(const ob_script_post *post, ob_request *r)
{
	const ob_script_path *path = (const ob_script_path *)(const void *)(post + 1);
	r->id = post->object, r->generation = post->generation;
	if (post->kind == OB_SCRIPT_STATE && post->used == sizeof r->state) {
		r->kind = OB_REQUEST_STATE;
		memcpy(&r->state, post + 1, sizeof r->state);
		return true;
	}
	if (post->kind == OB_SCRIPT_SURFACE && post->used == sizeof r->surface_velocity) {
		r->kind = OB_REQUEST_SURFACE;
		memcpy(&r->surface_velocity, post + 1, sizeof r->surface_velocity);
		return true;
	}
	if (post->kind != OB_SCRIPT_PATH || post->used < sizeof *path)
		return false;
	const size_t bytes = post->used - sizeof *path;
	r->kind = OB_REQUEST_PATH;
	r->path.points = (uint32_t)(bytes / sizeof *path->point);
	r->path.loop = path->loop, r->path.turns = path->turns;
	if (bytes > sizeof r->path.point)
		return false;
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
