#include "exchange/touches.h"

#include "exchange/results.h"

// True for a body whose script has an on_contact.
static bool feels(const ob_step_data *data, uint32_t id)
{
	const uint32_t cell = data->script_of[id];
	return cell && ob_schedule_is_dynamic(&data->schedule[id]) &&
	       data->script_turn[cell - 1].flags & OB_SCRIPT_FEELS;
}

bool ob_touches_are_felt(const ob_universe *u, const ob_island *is)
{
	const ob_step_data *data = ob_universe_step_data(u);
	bool felt = false;
	for (uint32_t i = 0; data->script_of && i < is->members && !felt; i++)
		felt = feels(data, data->member[is->first_member + i]);
	return felt;
}

void ob_touches_begin(ob_universe *u, const ob_island *is)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; data->script_of && i < is->members; i++) {
		const uint32_t id = data->member[is->first_member + i];
		if (feels(data, id))
			ob_commit_touch(u, id, OB_NO_OBJECT, 0, ob_v3(0, 0, 0));
	}
}

void ob_touches_note(ob_universe *u, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (!data->script_of)
		return;
	if (feels(data, a))
		ob_commit_touch(u, a, b, impulse, point);
	if (feels(data, b))
		ob_commit_touch(u, b, a, impulse, point);
}
