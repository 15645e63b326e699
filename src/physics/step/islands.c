#include "step/islands.h"

#include <stdlib.h>

#include "base/allocate.h"
#include "base/random.h"
#include "exchange/results.h"
#include "solver/estimate.h"
#include "solver/probe.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/publish.h"
#include "step/pairs.h"
#include "step/profile.h"
#include "step/state.h"
#include "step/terrain.h"

// ---- verify

// True errors of a sample of island steps (--set verify=on): a probe solves them with many more substeps, and the differences
// go into the counters. The sample follows from the lowest id of the island and the step: any worker takes the same.

enum { SAMPLED = 8 }; // one in so many island steps
static const uint64_t most_work = UINT64_C(1) << 27; // for an island; some seconds

static bool is_sampled(const ob_island_input *in)
{
	uint64_t key = in->step << 32 | in->object[0].id;
	return ob_splitmix(&key) % SAMPLED == 0;
}

// Bin of an error (m): its power of two.
static uint32_t bin_of(double error)
{
	const int bin = error > 0 ? ilogb(error) - OB_ERROR_LEAST_EXPONENT : 0;
	return bin < 0 ? 0 : bin < OB_ERROR_BINS ? (uint32_t)bin : OB_ERROR_BINS - 1;
}

static void count(ob_sim *s, const ob_motion *before, uint32_t row)
{
	const ob_island_work *w = &s->solver.island;
	ob_counters *c = &s->solver.counters;
	const double *v = w->v[row], radius = w->body[row].radius;
	const double moves = ob_max(ob_surface_speed(before->v, before->w, radius),
				    ob_surface_speed(ob_row_linear(v), ob_row_angular(v), radius));
	double speed;
	const double error = ob_probe_distance(s->verifier, w, row, &speed),
		     second = ob_max(error, ob_min(ob_error_of_time(error, speed, s->settings->step_length, 1), moves));
	c->verified_step[bin_of(error)]++;
	c->verified_second[bin_of(second)]++;
	c->verified_most[0] = ob_max(c->verified_most[0], error);
	c->verified_most[1] = ob_max(c->verified_most[1], second);
}

// Verifies the step of an island that has just been solved, if it belongs to the sample.
static void verify_sample(ob_sim *s, const ob_island_input *in)
{
	if (!s->verifier || !is_sampled(in))
		return;
	ob_profile_enter(s, OB_PROFILE_VERIFY);
	if (!ob_probe_try(s->verifier, in, OB_VERIFY_SUBSTEPS, most_work)) {
		s->solver.counters.unverified += in->members;
		return;
	}
	ob_probe_compare(s->verifier, &s->solver.island);
	for (uint32_t row = 1; row <= in->members; row++)
		count(s, in->object[row - 1].motion, row);
}

// ---- the solver's input

static void read_object(ob_sim *s, ob_island_object *to, uint32_t id, bool member)
{
	const ob_passport *p = ob_passport_of(s->u, id);
	const ob_motion *m = ob_newest_motion(s->u, id);
	const uint64_t step = s->scratch.in.step;
	*to = (ob_island_object){ .id = id,
				  .passport = p,
				  .hull = ob_hull_of(s->u, p),
				  .motion = m,
				  .now = ob_ballistic_state(s, id, m, (double)step * s->settings->step_length),
				  .path = ob_path_now(m, step) };
	if (member)
		to->torque = ob_script_torque(s->data, id);
}

// Reads the region of a pair with a terrain. Where it is flat it is a plane, an object of its own.
static void read_region(ob_sim *s, ob_island_pair *to, const ob_pair_key *k)
{
	ob_island_scratch *x = &s->scratch;
	const int side = !ob_terrain_is_first(s->u, k);
	const uint32_t number = x->terrains++;
	ob_terrain_view view;
	if (!ob_terrain_see(s->u, k, &view))
		return;
	if (!view.flat) {
		ob_terrain_take(view.terrain, view.region, &x->terrain[number]);
		to->part[side] = &x->terrain[number].hull;
		return;
	}
	const ob_passport *p = ob_passport_of(s->u, side ? k->b : k->a);
	ob_passport *plane = &x->plane[number];
	*plane = *p;
	plane->shape = OB_SHAPE_PLANE;
	plane->size = ob_v3(0, 0, 0);
	ob_island_object *object = &x->object[x->in.objects];
	*object = x->object[to->fixed];
	object->passport = plane;
	object->now.pose = view.plane;
	*(side ? &to->b : &to->a) = to->fixed = x->in.objects++;
}

// Number of pairs of an island with regions of terrain.
static uint32_t count_regions(const ob_sim *s, const ob_island *is)
{
	uint32_t n = 0;
	for (uint32_t i = 0; ob_universe_has_terrains(s->u) && i < is->pairs; i++)
		n += s->data->pair[s->data->island_pair[is->first_pair + i]].region > 0;
	return n;
}

// The member that is near most regions.
static uint32_t nearest_to_terrain(const ob_sim *s, const ob_island *is)
{
	const ob_step_data *data = s->data;
	const uint32_t *id = data->member + is->first_member;
	uint32_t *near = ob_allocate_zeroed(is->members * sizeof *near), most = 0;
	for (uint32_t i = 0; i < is->members; i++)
		s->scratch.index_of[id[i]] = i;
	for (uint32_t i = 0; i < is->pairs; i++) {
		const ob_pair_key *k = &data->pair[data->island_pair[is->first_pair + i]];
		if (k->region)
			near[s->scratch.index_of[ob_schedule_is_dynamic(&data->schedule[k->a]) ? k->a : k->b]]++;
	}
	for (uint32_t i = 0; i < is->members; i++)
		most = near[i] > near[most] ? i : most;
	free(near);
	return id[most];
}

// False if the island is near more regions than memory and time are meant for, and the step fails: each takes some 35 kB and
// 10 us in a substep, whatever it says that others do not.
static bool has_few_regions(ob_sim *s, const ob_island *is)
{
	if (count_regions(s, is) <= OB_SURFACES_OF_AN_ISLAND + OB_SURFACES_OF_A_BODY * (uint64_t)is->members)
		return true;
	ob_step_fail(s->u, OB_STEP_SURFACES_FULL, nearest_to_terrain(s, is));
	return false;
}

// Makes room for the terrains' regions of an island, and for planes in their place.
static void reserve_terrains(ob_sim *s, const ob_island *is)
{
	ob_island_scratch *x = &s->scratch;
	const uint32_t n = count_regions(s, is);
	x->terrains = 0;
	if (n <= x->terrains_max)
		return;
	x->terrains_max = n + n / 2;
	x->terrain = ob_reallocate(x->terrain, x->terrains_max * sizeof *x->terrain);
	x->plane = ob_reallocate(x->plane, x->terrains_max * sizeof *x->plane);
}

// Reads pair "pair" of the universe. The objects of the island that it names for the first time are read, too.
static void read_pair(ob_sim *s, ob_island_pair *to, uint32_t pair)
{
	ob_island_scratch *x = &s->scratch;
	const ob_pair_key *k = &s->data->pair[pair];
	const uint32_t fixed = !ob_schedule_is_dynamic(&s->data->schedule[k->a])   ? k->a
			       : !ob_schedule_is_dynamic(&s->data->schedule[k->b]) ? k->b
										   : UINT32_MAX;
	if (fixed != UINT32_MAX) {
		const uint32_t at = x->index_of[fixed];
		if (at >= x->in.objects || at < x->in.members || x->object[at].id != fixed ||
		    (k->region && x->object[at].passport->shape == OB_SHAPE_PLANE)) {
			x->index_of[fixed] = x->in.objects;
			read_object(s, &x->object[x->in.objects++], fixed, false);
		}
	}
	const ob_pair_state *before = ob_pair_state_before(s->u, k);
	*to = (ob_island_pair){ .pair = pair,
				.a = x->index_of[k->a],
				.b = x->index_of[k->b],
				.fixed = fixed == UINT32_MAX ? OB_NO_FIXED : x->index_of[fixed],
				.limit = k->limit,
				.kept = k->record != OB_NO_RECORD,
				.before = before };
	if (k->part_a | k->part_b)
		for (int side = 0; side < 2; side++)
			to->part[side] = ob_part_of(s->u, ob_passport_of(s->u, side ? k->b : k->a),
						    side ? k->part_b : k->part_a);
	if (k->region)
		read_region(s, to, k);
	if (before) {
		const ob_pair_record *r = &s->data->record[k->record];
		to->newest = r->stamp[before - r->version] == x->in.step + 1;
		to->impulse_b = s->data->impulse_b ? s->data->impulse_b[k->record][before - r->version] : NULL;
	}
}

// Returns the place of a joint's end in the input; one that is not simulated is read when it is named for the first time.
static uint32_t read_end(ob_sim *s, uint32_t id)
{
	ob_island_scratch *x = &s->scratch;
	if (id == OB_JOINT_WORLD)
		return OB_NO_FIXED;
	if (!ob_schedule_is_dynamic(&s->data->schedule[id])) {
		const uint32_t at = x->index_of[id];
		if (at < x->in.members || at >= x->in.objects || x->object[at].id != id) {
			x->index_of[id] = x->in.objects;
			read_object(s, &x->object[x->in.objects++], id, false);
		}
	}
	return x->index_of[id];
}

// Reads the joints of a member, those of two members with the first of these.
static void read_joints(ob_sim *s, uint32_t id)
{
	ob_island_scratch *x = &s->scratch;
	for (uint32_t j = ob_joint_first(s->data, id); j; j = ob_joint_next(s->data, j, id)) {
		const ob_joint_passport *joint = &s->data->joint[j - 1];
		if (joint->kind == OB_JOINT_APART || !ob_joint_holds(s->u, joint))
			continue; // its other object may be another worker's
		const uint32_t other = joint->object[joint->object[0] == id];
		const bool moves = other != OB_JOINT_WORLD && other < s->data->objects_max &&
				   ob_schedule_is_dynamic(&s->data->schedule[other]);
		if (moves && joint->object[1] == id)
			continue;
		if (x->in.joints == x->joints_max) {
			x->joints_max = 2 * x->joints_max + 16;
			x->joint = ob_reallocate(x->joint, x->joints_max * sizeof *x->joint);
			x->in.joint = x->joint;
		}
		x->joint[x->in.joints++] =
			(ob_island_joint){ .number = j - 1,
					   .joint = joint,
					   .object = { read_end(s, joint->object[0]), read_end(s, joint->object[1]) } };
	}
}

// Number of joints of the members, those of two of them twice.
static uint32_t count_joints(const ob_sim *s, const ob_island *is)
{
	uint32_t n = 0;
	for (uint32_t i = 0; ob_joints_end(s->data) && i < is->members; i++) {
		const uint32_t id = s->data->member[is->first_member + i];
		for (uint32_t j = ob_joint_first(s->data, id); j; j = ob_joint_next(s->data, j, id))
			n++;
	}
	return n;
}

static const ob_island_input *read_island(ob_sim *s, const ob_island *is)
{
	ob_island_scratch *x = &s->scratch;
	const bool terrain = ob_universe_has_terrains(s->u);
	const uint32_t objects =
		is->members + (terrain ? 2 : 1) * is->pairs + count_joints(s, is); // fixed ones at most
	if (terrain)
		reserve_terrains(s, is);
	if (objects > x->objects_max) {
		x->objects_max = objects + objects / 2;
		x->object = ob_reallocate(x->object, x->objects_max * sizeof *x->object);
	}
	if (is->pairs > x->pairs_max) {
		x->pairs_max = is->pairs + is->pairs / 2;
		x->pair = ob_reallocate(x->pair, x->pairs_max * sizeof *x->pair);
	}
	x->in = (ob_island_input){ .step = ob_step_count(s->u),
				   .members = is->members,
				   .objects = is->members,
				   .pairs = is->pairs,
				   .object = x->object,
				   .pair = x->pair,
				   .joint = x->joint,
				   .feels = ob_touches_are_felt(s->u, is) };
	for (uint32_t i = 0; i < is->members; i++) {
		const uint32_t id = s->data->member[is->first_member + i];
		x->index_of[id] = i;
		read_object(s, &x->object[i], id, true);
	}
	for (uint32_t i = 0; i < is->pairs; i++)
		read_pair(s, &x->pair[i], s->data->island_pair[is->first_pair + i]);
	for (uint32_t i = 0; ob_joints_end(s->data) && i < is->members; i++)
		read_joints(s, x->object[i].id);
	x->island = is;
	return &x->in;
}

bool ob_island_scratch_create(ob_sim *s)
{
	s->scratch.index_of = calloc(ob_universe_capacity(s->u), sizeof *s->scratch.index_of);
	return s->scratch.index_of;
}

void ob_island_scratch_finish(ob_sim *s)
{
	free(s->scratch.index_of);
	free(s->scratch.object);
	free(s->scratch.pair);
	free(s->scratch.joint);
	free(s->scratch.terrain);
	free(s->scratch.plane);
}

// ---- requests and reports of the solver

static void enter_section(void *sim, ob_profile_section section)
{
	ob_profile_change(sim, section);
}

static void begin_attempt(void *sim)
{
	ob_sim *s = sim;
	if (s->scratch.in.feels)
		ob_touches_begin(s->u, s->scratch.island);
}

static void note_touch(void *sim, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	ob_touches_note(((ob_sim *)sim)->u, a, b, impulse, point);
}

static void fail(void *sim, uint32_t object)
{
	ob_step_fail(((ob_sim *)sim)->u, OB_STEP_ENGINE, object);
}

static void hand_over_contact(void *sim, const ob_found_contact *c)
{
	ob_commit_contact(((ob_sim *)sim)->u, c);
}

static void hand_over_joint(void *sim, const ob_found_joint *j)
{
	ob_commit_joint(((ob_sim *)sim)->u, j);
}

static void publish_body(void *sim, const ob_island_object *object, ob_motion *m, bool free)
{
	ob_sim *s = sim;
	ob_state end = { { m->p, m->q }, m->v, m->w };
	if (free && s->solver.methods.exact) { // the substeps only searched for impacts
		const ob_motion flight = ob_ballistic_flight(s, object->id);
		end = ob_ballistic_state(s, object->id, &flight, m->t0);
		m->t0 = flight.t0, m->valid_until = flight.valid_until;
		m->p = flight.p, m->q = flight.q, m->v = flight.v, m->w = flight.w;
	}
	ob_body_publish(s, object->id, m, &end);
}

ob_island_calls ob_island_calls_of(ob_sim *s)
{
	return (ob_island_calls){ .with = s,
				  .spend = ob_budget_spend,
				  .enter = enter_section,
				  .attempt = begin_attempt,
				  .touch = note_touch,
				  .fail = fail,
				  .contact = hand_over_contact,
				  .joint = hand_over_joint,
				  .motion = publish_body };
}

// ---- what it costs

// Returns the cost in solves of a pair; a collision test costs as much as a few.
static uint64_t cost_so_far(const ob_sim *s)
{
	enum { OF_A_TEST = 4 };
	return s->solver.counters.pair_solves + OF_A_TEST * s->solver.counters.narrowphase_tests;
}

// Notes each member's share of the cost, by which the scheduler begins expensive islands first.
static void note_effort(ob_sim *s, uint32_t island, uint64_t cost)
{
	const uint64_t share = cost / s->data->island[island].members;
	ob_commit_effort(s->u, island,
			 s->solver.budget.spent   ? OB_EFFORT_GIVEN_UP
			 : share < OB_EFFORT_MOST ? (uint32_t)share
						  : OB_EFFORT_MOST);
}

// ---- ballistic advance

// True if the pair is one of a whole object with a plane, or with a terrain that is a plane there.
static bool is_with_plane(const ob_sim *s, const ob_pair_key *k)
{
	ob_terrain_view view;
	return !k->part_a && !k->part_b &&
	       (s->data->schedule[k->a].state == OB_SCHEDULE_PLANE ||
		s->data->schedule[k->b].state == OB_SCHEDULE_PLANE ||
		(k->region && ob_terrain_see(s->u, k, &view) && view.flat));
}

// True for a body near planes only, or two that are no compounds near each other and planes, with no resting contact, and
// no late contact in this step: a ballistic advance may suffice. A contact rests if it carried a load, or if the body has
// been slow.
static bool may_advance_ballistically(const ob_sim *s, const ob_island *is)
{
	const ob_step_data *data = s->data;
	const uint32_t *id = data->member + is->first_member;
	if (is->members > 2 || (is->pairs && (data->count->merged || !s->solver.methods.exact)))
		return false;
	for (uint32_t i = 0; i < is->members; i++)
		if (ob_joint_first(data, id[i]))
			return false;
	for (uint32_t i = 0; data->script_of && i < is->members; i++)
		if (ob_norm2(ob_script_torque(data, id[i])) > 0)
			return false;
	for (uint32_t i = 0; i < is->pairs; i++) {
		const ob_pair_key *k = &data->pair[data->island_pair[is->first_pair + i]];
		const bool met = data->result_island[k->a] == data->result_island[k->b] && !ob_pair_parts(k);
		const uint32_t body = ob_schedule_is_dynamic(&data->schedule[k->a]) ? k->a : k->b;
		if ((k->active && (ob_newest_motion(s->u, body)->rest_time > 0 ||
				   ob_pair_carried_load(ob_pair_state_before(s->u, k)))) ||
		    (!met && !is_with_plane(s, k)))
			return false;
	}
	return true;
}

// Ends the island's contacts; the next solver tests their geometry anew.
static void end_contacts(ob_sim *s, const ob_island *is)
{
	for (uint32_t i = 0; i < is->pairs; i++) {
		const uint32_t pair = s->data->island_pair[is->first_pair + i];
		if (s->data->pair[pair].active)
			ob_commit_contact(s->u, &(ob_found_contact){ .pair = pair, .limit = -INFINITY });
	}
}

static bool advance_pair(ob_sim *s, const ob_island *is)
{
	if (is->members != 2 || !may_advance_ballistically(s, is))
		return false;
	ob_profile_enter(s, OB_PROFILE_BALLISTIC);
	ob_touches_begin(s->u, is);
	if (!ob_ballistic_pair_advance(s, s->data->member + is->first_member))
		return false;
	end_contacts(s, is);
	s->solver.counters.ballistic_advances += is->members;
	return true;
}

void ob_islands_fly(ob_sim *s, uint32_t first, uint32_t n, bool *flown)
{
	const ob_step_data *data = s->data;
	uint32_t lone[OB_ISLANDS_ABREAST], id[OB_ISLANDS_ABREAST], fly = 0;
	bool done[OB_ISLANDS_ABREAST];
	ob_budget_begin_share(s, data->member[data->island[first].first_member]);
	ob_profile_enter(s, OB_PROFILE_BALLISTIC);
	for (uint32_t k = 0; k < n; k++) {
		const ob_island *is = &data->island[first + k];
		flown[k] = false;
		if (is->members != 1 || !may_advance_ballistically(s, is))
			continue;
		ob_touches_begin(s->u, is);
		lone[fly] = k, id[fly++] = data->member[is->first_member];
	}
	s->fly(s, id, fly, done);
	for (uint32_t i = 0; i < fly; i++)
		if ((flown[lone[i]] = done[i])) {
			end_contacts(s, &data->island[first + lone[i]]);
			s->solver.counters.ballistic_advances++;
		}
}

// ---- the step

void ob_island_advance(ob_sim *s, uint32_t i)
{
	const ob_island *is = &s->data->island[i];
	ob_budget_begin_share(s, s->data->member[is->first_member]);
	if (advance_pair(s, is))
		return;
	if (!has_few_regions(s, is)) {
		ob_commit_effort(s->u, i, OB_EFFORT_GIVEN_UP);
		return;
	}
	const uint64_t before = cost_so_far(s);
	ob_profile_enter(s, OB_PROFILE_LOAD);
	const ob_island_input *in = read_island(s, is);
	ob_island_solve(&s->solver, in);
	verify_sample(s, in);
	note_effort(s, i, cost_so_far(s) - before);
}
