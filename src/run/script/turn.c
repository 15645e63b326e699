// Parts that turns of Lua and of FMUs share: their beginning, their requests, their end.
#include <stdio.h>
#include <string.h>

#include "script/runner.h"

void ob_script_clear_requests(ob_script_runner *r, const ob_script_turn *turn)
{
	ob_script_cell *c = r->cell;
	c->asks = 0;
	c->outbox_bytes = 0;
	c->force = ob_passport_of(r->u, turn->object)->force;
	c->next_torque = c->torque;
	c->push = c->twist = ob_v3(0, 0, 0);
}

void ob_script_begin_turn(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c)
{
	r->cell = c;
	r->turn = t;
	r->step = ob_step_count(r->u);
	ob_script_clear_requests(r, t);
}

void ob_script_stop_turn(ob_script_runner *r, ob_script_turn *t, const ob_error *why)
{
	ob_script_cell *c = r->cell;
	t->flags |= OB_SCRIPT_STOPPED;
	c->asks = OB_SCRIPT_ASKS_ERROR;
	c->outbox_bytes = 0;
	c->failed_step = (uint32_t)r->step;
	snprintf(c->error, sizeof c->error, "%.*s", OB_SCRIPT_ERROR_BYTES - 1, why->text);
}

void ob_script_leave(ob_script_runner *r)
{
	ob_script_cell *c = r->cell;
	const ob_script_post post = { .kind = OB_REQUEST_REMOVE,
				      .object = r->turn->object,
				      .generation = r->turn->generation };
	if (c->outbox_bytes + sizeof post > OB_SCRIPT_OUTBOX_BYTES)
		c->outbox_bytes = 0; // its last requests are lost
	memcpy(c->outbox + c->outbox_bytes, &post, sizeof post);
	c->outbox_bytes += (uint32_t)sizeof post;
	c->asks |= OB_SCRIPT_ASKS_POST;
}
