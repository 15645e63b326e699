#include "measure/colouring.h"

#include <math.h>
#include <string.h>

static const double golden_turn = .6180339887498949; // of a circle: neighbouring numbers get distant hues
static const float none[3] = { .28f, .30f, .33f };
static const float rest[][3] = {
	[OB_REST_TOUCHES] = { .85f, .30f, .04f },
	[OB_REST_FLIES] = { .08f, .55f, .80f },
	[OB_REST_EQUILIBRIUM] = { .10f, .50f, .20f },
	[OB_REST_ASLEEP] = { .09f, .13f, .40f },
};
static const double most_substeps = 512;
static const double least_lead = 1e-3, most_lead = 1; // s

// Bright for even turns of the hue, darker for odd ones.
void ob_colour_of_number(uint32_t number, float out[3])
{
	const double hue = 6 * fmod(golden_turn * number, 1), value = number / 3 % 2 ? .36 : .66, least = .11;
	for (int i = 0; i < 3; i++) {
		const double at = fmod(hue + 4 - 2 * i, 6); // distance from the channel's own hue, in sixths
		const double share = fmax(0, fmin(1, fabs(at - 3) - 1));
		out[i] = (float)(least + share * (value - least));
	}
}

ob_rest ob_rest_of(const ob_motion *m)
{
	if (m->flags & OB_MOTION_RESTS)
		return m->flags & OB_MOTION_ASLEEP ? OB_REST_ASLEEP : OB_REST_EQUILIBRIUM;
	return !(m->flags & OB_MOTION_SWINGS) && ob_norm2(m->a) > 0 ? OB_REST_FLIES : OB_REST_TOUCHES;
}

void ob_colour_of_share(double share, float out[3])
{
	if (isnan(share)) {
		memcpy(out, none, 3 * sizeof *out);
		return;
	}
	share = fmax(0, fmin(1, share));
	out[0] = (float)(.03 + .87 * fmin(1, 2 * share));
	out[1] = (float)(.03 + .72 * share * share);
	out[2] = (float)(.22 * fmax(0, 1 - 2 * share) + .10 * share);
}

static double share_of_cost(const ob_motion *m)
{
	const bool solved = !(m->flags & OB_MOTION_RESTS) && m->substeps > 0;
	return solved ? log2(m->substeps) / log2(most_substeps) : NAN;
}

double ob_share_of_lead(double lead)
{
	return isnan(lead) ? NAN : log2(1 + fmax(0, lead) / least_lead) / log2(1 + most_lead / least_lead);
}

// The colour of a worker, of its rank, or of the first worker of its process.
static void colour_of_home(const ob_colouring *c, uint32_t home, float out[3])
{
	uint32_t first = 0;
	if (home >= c->workers) {
		memcpy(out, none, 3 * sizeof *out);
		return;
	}
	while (c->place[first].pid != c->place[home].pid)
		first++;
	ob_colour_of_number(c->key == OB_COLOUR_WORKER ? home
			    : c->key == OB_COLOUR_RANK ? c->place[home].rank
						       : first,
			    out);
}

static bool has_simulator(const ob_snapshot *s, uint32_t id)
{
	return !(s->passport[id].flags & OB_OBJECT_PRESCRIBED);
}

void ob_colouring_of(const ob_colouring *c, const ob_snapshot *s, uint32_t id, float colour[3])
{
	const ob_motion *m = &s->motion[id];
	if (c->key == OB_COLOUR_OWN)
		memcpy(colour, s->passport[id].colour, 3 * sizeof *colour);
	else if (!has_simulator(s, id))
		memcpy(colour, none, 3 * sizeof *colour);
	else if (c->key == OB_COLOUR_SIMULATOR)
		ob_colour_of_number(id, colour);
	else if (c->key == OB_COLOUR_ISLAND)
		ob_colour_of_number(m->flags & OB_MOTION_SWINGS ? id : m->island, colour);
	else if (c->key == OB_COLOUR_REST)
		memcpy(colour, rest[ob_rest_of(m)], 3 * sizeof *colour);
	else if (c->key == OB_COLOUR_COST)
		ob_colour_of_share(share_of_cost(m), colour);
	else if (c->key == OB_COLOUR_LAG)
		ob_colour_of_share(s->own_time ? ob_share_of_lead(s->own_time[id] - s->time) : NAN, colour);
	else
		colour_of_home(c, s->home ? s->home[id] : UINT32_MAX, colour);
}
