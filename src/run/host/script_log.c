#include "host/script_log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/log.h"
#include "base/utf8.h"
#include "host/request_table.h"

enum { LOGGED = 20 }; // errors that are logged one by one

// Warns once of each script that does something without effect.
static void log_warning(ob_script_log *l, const ob_universe *u, const ob_script_turn *turn, const char *warning)
{
	const uint64_t bit = (uint64_t)1 << (turn->script - 1) % OB_SCRIPTS_MAX;
	if (!(l->warned & bit))
		ob_log_warn("the script of object %u (%.*s): %s", turn->object, OB_NAME_MAX,
			    ob_passport_of(u, turn->object)->name, warning);
	l->warned |= bit;
}

static void keep(ob_script_log *l, const ob_script_error *e)
{
	if (OB_MAKE_ROOM(l->error, l->errors, l->errors_max))
		l->error[l->errors++] = *e;
}

static void log_error(const ob_script_log *l, const ob_universe *u, const ob_script_error *e)
{
	if (l->errors == LOGGED + 1)
		ob_log_warn("more scripts were stopped: the report has their number");
	else if (l->errors <= LOGGED)
		ob_log_warn("the script of object %u (%.*s) was stopped at %g s: %s", e->object, OB_NAME_MAX, e->name,
			    (double)(e->step - 1) * ob_universe_settings(u)->step_length, e->text);
}

// Looks at a script that an error has stopped, or that is warned of.
static void look_at(ob_script_log *l, const ob_universe *u, uint32_t cell)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_script_turn *turn = &data->script_turn[cell];
	const ob_script_cell *c = &data->script_cell[cell];
	ob_script_error e = { .step = (uint64_t)c->failed_step + 1,
			      .object = turn->object,
			      .generation = turn->generation };
	memcpy(e.name, ob_passport_of(u, turn->object)->name, sizeof e.name);
	memcpy(e.text, c->error, OB_SCRIPT_ERROR_BYTES);
	ob_utf8_make_plain(e.text);
	if (!*e.text) // its object was frozen
		return;
	if (!(turn->flags & OB_SCRIPT_STOPPED)) {
		log_warning(l, u, turn, e.text);
		return;
	}
	const uint64_t who = (uint64_t)turn->generation << 32 | turn->object;
	if (cell >= l->cells && OB_GROW_CLEARED(l->last, l->cells, (size_t)cell + 1))
		l->cells = cell + 1;
	if (cell < l->cells && l->last[cell] == who)
		return;
	if (cell < l->cells)
		l->last[cell] = who;
	keep(l, &e);
	log_error(l, u, &e);
}

void ob_script_log_look(ob_script_log *l, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_script_counts *count = data->script_counts;
	if (!count || count->failed == l->failed)
		return;
	l->failed = count->failed;
	for (uint32_t i = 0; i < count->cells && i < data->script_cells; i++)
		if (data->script_turn[i].script &&
		    data->script_turn[i].flags & (OB_SCRIPT_STOPPED | OB_SCRIPT_WARNED) &&
		    data->script_turn[i].object < data->objects_max)
			look_at(l, u, i);
}

static int by_step(const void *pa, const void *pb)
{
	const ob_script_error *a = pa, *b = pb;
	if (a->step != b->step)
		return a->step < b->step ? -1 : 1;
	if (a->object != b->object)
		return a->object < b->object ? -1 : 1;
	return (a->generation > b->generation) - (a->generation < b->generation);
}

uint32_t ob_script_log_first(ob_script_log *l, ob_script_error *out, uint32_t most)
{
	uint32_t n = 0;
	if (l->errors)
		qsort(l->error, l->errors, sizeof *l->error, by_step);
	for (size_t i = 0; i < l->errors && n < most; i++)
		if (i == 0 || by_step(&l->error[i - 1], &l->error[i]) != 0) // else kept twice, across a restart
			out[n++] = l->error[i];
	return n;
}

void ob_script_log_finish(ob_script_log *l)
{
	free(l->last);
	free(l->error);
}

// ---- script request

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
