// Cells of scripted objects (step_data.h): allocated and freed by the host while the universe is paused.
#include <string.h>

#include "table/layout.h"
#include "table/pages.h"

// First free cell; the number of cells if there is none.
static uint32_t free_cell(const ob_step_data *data)
{
	uint32_t cell = 0;
	while (cell < data->script_cells && data->script_turn[cell].script)
		cell++;
	return cell;
}

bool ob_script_take_cell(ob_universe *u, uint32_t id, uint32_t script, const void *state, uint32_t state_bytes,
			 const uint64_t random[4])
{
	ob_step_data *data = &u->step_data;
	const uint32_t cell = free_cell(data);
	if (cell == data->script_cells || state_bytes > OB_SCRIPT_STATE_BYTES ||
	    !ob_pages_take(u, OB_AREA_SCRIPT_CELL, cell, 1) || !ob_pages_take(u, OB_AREA_PASSPORT_EVEN, id, 1))
		return false;
	ob_script_cell *c = &data->script_cell[cell];
	memset(c, 0, sizeof *c);
	memcpy(c->random, random, sizeof c->random);
	if (state_bytes)
		memcpy(c->state, state, state_bytes);
	c->state_bytes = state_bytes;
	data->script_turn[cell] = (ob_script_turn){
		.object = id, .generation = ob_passport_of(u, id)->generation, .script = script + 1, .wake = UINT32_MAX
	};
	data->script_of[id] = cell + 1;
	if (cell >= data->script_counts->cells)
		data->script_counts->cells = cell + 1;
	return true;
}

void ob_script_free_cell(ob_universe *u, uint32_t id)
{
	ob_step_data *data = &u->step_data;
	if (!data->script_cells || !data->script_of[id] || data->script_of[id] > data->script_cells)
		return;
	data->script_turn[data->script_of[id] - 1] = (ob_script_turn){ 0 };
	data->script_of[id] = 0;
}

void ob_script_stop(ob_universe *u, uint32_t id)
{
	ob_step_data *data = &u->step_data;
	const ob_script_turn *turn = ob_script_turn_of(u, id);
	if (!turn || turn->flags & OB_SCRIPT_STOPPED)
		return;
	data->script_turn[data->script_of[id] - 1].flags |= OB_SCRIPT_STOPPED;
	*data->script_cell[data->script_of[id] - 1].error = 0;
}

const ob_script_turn *ob_script_turn_of(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = &u->step_data;
	if (!data->script_cells || id >= data->objects_max)
		return NULL;
	const uint32_t cell = data->script_of[id];
	return cell && cell <= data->script_cells ? &data->script_turn[cell - 1] : NULL;
}

void ob_script_count(const ob_universe *u, uint64_t *stopped, uint64_t *warned)
{
	const ob_step_data *data = &u->step_data;
	*stopped = data->script_counts ? data->script_counts->stopped : 0;
	*warned = 0;
	for (uint32_t i = 0; i < data->script_cells; i++) {
		const ob_script_turn *t = &data->script_turn[i];
		*warned += t->script && (t->flags & (OB_SCRIPT_STOPPED | OB_SCRIPT_WARNED)) == OB_SCRIPT_WARNED;
	}
}

bool ob_script_deliver(ob_universe *u, uint32_t id, const void *values, uint32_t bytes)
{
	ob_step_data *data = &u->step_data;
	if (!ob_script_turn_of(u, id))
		return false;
	ob_script_turn *turn = &data->script_turn[data->script_of[id] - 1];
	ob_script_cell *c = &data->script_cell[data->script_of[id] - 1];
	const ob_script_post mail = {
		.kind = OB_REQUEST_MESSAGE, .bytes = (bytes + 7) / 8 * 8, .used = bytes, .object = UINT32_MAX
	};
	if (turn->flags & OB_SCRIPT_STOPPED)
		return true;
	if (c->inbox_bytes + sizeof mail + mail.bytes > OB_SCRIPT_INBOX_BYTES)
		return false;
	memcpy(c->inbox + c->inbox_bytes, &mail, sizeof mail);
	memset(c->inbox + c->inbox_bytes + sizeof mail, 0, mail.bytes);
	if (bytes)
		memcpy(c->inbox + c->inbox_bytes + sizeof mail, values, bytes);
	c->inbox_bytes += (uint32_t)sizeof mail + mail.bytes;
	turn->flags |= OB_SCRIPT_MAIL;
	return true;
}
