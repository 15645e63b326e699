#include "relation.h"

#include <stdlib.h>
#include <string.h>

#include "motion/random.h"

static const double tolerance = 1e-9; // m
static const double pebble_mass = 1e-9; // mass, relative to the body on which it lies
static const double pebble_size = .1; // half extent, relative to that body's least one
static const double joined_limit =
	1e-6; // m: largest deviation in a scene with a pebble or with joints that change nothing
static const double disturbance = 1e-12; // m, for the twin
// Pairs of twins: for each scene, and for one in which a relation seems to fail. Where motion forks, half of all twins
// may take the other way.
enum { TWINS = 1, TWINS_IN_DOUBT = 8 };
static const double pi = 3.14159265358979323846;

const char *const relation_name[RELATIONS] = { "again",   "workers",   "mirrored", "turned",   "tilted", "moved",
					       "boosted", "reordered", "rescaled", "refined",  "far",    "momentum",
					       "spin",    "energy",    "lifted",   "reframed", "pebble", "neighbour",
					       "idle",    "cut",       "bolted" };

// ---- one scene, transformed

// A position p of the original becomes length * turn (mirror p) + shift + boost t.
typedef struct view {
	bool mirror; // x to -x, first
	ob_quat turn;
	ob_vec3 shift, boost, lift; // in units of the transformed scene
	ob_quat frame; // for hulls: turns the points of the transformed scene
	double length, time, mass; // factors from the original's numbers
	uint32_t id[SCENE_BODIES]; // id of each of the original's bodies
} view;

static view same_view(const random_scene *s)
{
	view o = { .turn = ob_quat_identity(), .frame = ob_quat_identity(), .length = 1, .time = 1, .mass = 1 };
	for (uint32_t i = 0; i < s->bodies; i++)
		o.id[i] = i;
	return o;
}

static ob_vec3 see_vector(const view *o, ob_vec3 x)
{
	ob_mat3 r = ob_quat_matrix(o->turn);
	return ob_rotate(&r, ob_v3(o->mirror ? -x.x : x.x, x.y, x.z));
}

// Transforms an angular velocity; its mirror image turns the other way.
static ob_vec3 see_axial(const view *o, ob_vec3 x)
{
	ob_mat3 r = ob_quat_matrix(o->turn);
	return ob_rotate(&r, o->mirror ? ob_v3(x.x, -x.y, -x.z) : x);
}

// The body is mirrored in its own x, too, which leaves all shapes unchanged.
static ob_quat see_attitude(const view *o, ob_quat q)
{
	return ob_quat_mul(o->turn, o->mirror ? (ob_quat){ q.w, q.x, -q.y, -q.z } : q);
}

static ob_state see_state(const view *o, const scene_body *b, ob_state s, double time)
{
	const ob_vec3 v = ob_madd(o->boost, .5 * time * o->time, o->lift);
	ob_vec3 p = ob_madd(ob_add(ob_scale(see_vector(o, s.pose.p), o->length), o->shift), time * o->time, v);
	ob_state r = { { p, see_attitude(o, s.pose.q) },
		       ob_add(ob_scale(see_vector(o, s.v), o->length / o->time),
			      ob_madd(o->boost, time * o->time, o->lift)),
		       ob_scale(see_axial(o, s.w), 1 / o->time) };
	if (b->shape == OB_SHAPE_HULL)
		r.pose.q = ob_quat_mul(r.pose.q, (ob_quat){ o->frame.w, -o->frame.x, -o->frame.y, -o->frame.z });
	return r;
}

// Transforms from the body's own frame, mirrored like its attitude, to the same.
static ob_vec3 see_own(const view *o, const scene_body *b, ob_vec3 x)
{
	const ob_mat3 r = ob_quat_matrix(o->frame);
	const ob_vec3 seen = ob_v3(o->mirror ? -x.x : x.x, x.y, x.z);
	return b->shape == OB_SHAPE_HULL ? ob_rotate(&r, seen) : seen;
}

static void see_body(const view *o, const scene_body *from, scene_body *to)
{
	*to = *from;
	to->size = ob_scale(from->size, o->length);
	to->mass *= o->mass;
	to->state = see_state(o, from, from->state, 0);
	to->running = ob_scale(see_own(o, from, from->running), o->length / o->time);
	to->path.frequency /= o->time;
	to->path.a = ob_scale(see_vector(o, from->path.a), o->length / (o->time * o->time));
	to->push.force = ob_scale(see_vector(o, from->push.force), o->mass * o->length / (o->time * o->time));
	to->push.frequency /= o->time;
	to->push.from *= o->time;
	to->push.until *= o->time;
	for (uint32_t i = 0; i < from->points; i++)
		to->point[i] = ob_scale(see_own(o, from, from->point[i]), o->length);
	if (from->mass > 0)
		return;
	to->driven |= ob_norm2(o->boost) > 0 && from->shape != OB_SHAPE_PLANE;
	if (!to->driven)
		to->state.v = to->state.w = ob_v3(0, 0, 0);
}

static random_scene see_scene(const view *o, const random_scene *s)
{
	random_scene r = *s;
	r.run.gravity = ob_add(ob_scale(see_vector(o, s->run.gravity), o->length / (o->time * o->time)), o->lift);
	r.lift = o->lift;
	r.run.step_length *= o->time;
	r.run.tolerance *= o->length;
	for (uint32_t i = 0; i < s->bodies; i++)
		see_body(o, &s->body[i], &r.body[o->id[i]]);
	return r;
}

// ---- differences

static double between(const scene_body *b, const ob_state *x, const ob_state *y)
{
	double turned = 0, r = b->shape == OB_SHAPE_SPHERE ? b->size.x : ob_shape_radius(b->shape, b->size);
	ob_mat3 rx = ob_quat_matrix(x->pose.q), ry = ob_quat_matrix(y->pose.q);
	for (int i = 0; i < 3; i++)
		turned = fmax(turned, ob_norm(ob_sub(ob_column(&rx, i), ob_column(&ry, i))));
	return ob_norm(ob_sub(x->pose.p, y->pose.p)) + r * turned;
}

static double sample_time(const random_scene *s, int sample, uint64_t steps)
{
	return (double)((uint64_t)(sample + 1) * steps / PLAY_SAMPLES) * s->run.step_length;
}

// Distance (m, in the original's units) of the other run from the transformed original; infinity if it could not be
// run.
static double difference(const random_scene *s, const played *base, const played *other, const view *o, int sample,
			 uint64_t steps)
{
	double most = 0;
	for (uint32_t i = 0; i < s->bodies; i++) {
		if (s->body[i].mass == 0)
			continue;
		scene_body body = s->body[i];
		ob_state expected = see_state(o, &body, base->at[sample][i], sample_time(s, sample, steps));
		body.size = ob_scale(body.size, o->length);
		double d = between(&body, &expected, &other->at[sample][o->id[i]]) / o->length;
		if (!(d <= most))
			most = isnan(d) ? INFINITY : d;
	}
	return other->failed ? INFINITY : most;
}

static ob_vec3 random_direction(uint64_t *seed)
{
	ob_vec3 x = random_vector(seed, 1);
	return ob_scale(x, 1 / ob_norm(x));
}

// Displaces positions and attitudes: rounding disturbs both.
static random_scene twin_of(const random_scene *s, uint64_t seed, double sign)
{
	random_scene t = *s;
	for (uint32_t i = 0; i < s->bodies; i++) {
		const scene_body *b = &s->body[i];
		const ob_vec3 off = random_direction(&seed), turn = random_direction(&seed);
		if (!(b->mass > 0))
			continue;
		ob_pose *to = &t.body[i].state.pose;
		to->p = ob_madd(to->p, sign * disturbance, off);
		to->q = ob_quat_turn(to->q, ob_scale(turn, sign * disturbance / ob_shape_radius(b->shape, b->size)));
	}
	return t;
}

// Ends the comparison of motions where one of some twins deviates.
static void watch_twins(original *o, uint64_t first, uint64_t last, uint64_t steps)
{
	const view same = same_view(o->scene);
	played twin;
	for (uint64_t k = 2 * first; k < 2 * last; k++) { // apart and together, in the air and in the ground
		int sample = 0;
		random_scene t = twin_of(o->scene, 1 + k / 2, k % 2 ? 1 : -1);
		play(&t, 0, steps, &twin);
		while (sample < o->samples && difference(o->scene, &o->base, &twin, &same, sample, steps) <= tolerance)
			sample++;
		o->samples = sample;
	}
}

original relation_original(const random_scene *s, uint64_t steps)
{
	original o = { .scene = s, .samples = PLAY_SAMPLES };
	play(s, 0, steps, &o.base);
	o.valid = !o.base.failed && o.base.depth < 1e-6;
	if (o.valid)
		watch_twins(&o, 0, TWINS, steps);
	return o;
}

// ---- relations

static ob_vec3 vertical(const random_scene *s)
{
	double g = ob_norm(s->run.gravity);
	return g > 0 ? ob_scale(s->run.gravity, -1 / g) : ob_v3(0, 0, 0);
}

static void turn(const random_scene *s, uint64_t *seed, view *o)
{
	ob_vec3 up = vertical(s);
	o->turn = ob_norm(s->run.gravity) == 0 ? random_attitude(seed)
					       : ob_quat_turn(o->turn, ob_scale(up, within(seed, -pi, pi)));
}

// Finds a direction along all planes, for frictionless bodies gliding along them: speed in it must make no difference.
// Returns false if there are other bodies, or no such direction.
static bool along_planes(const random_scene *s, uint64_t *seed, ob_vec3 *direction)
{
	ob_vec3 along = random_direction(seed);
	for (uint32_t i = 0; i < s->bodies; i++) {
		ob_mat3 r = ob_quat_matrix(s->body[i].state.pose.q);
		ob_vec3 normal = ob_column(&r, 2);
		if (s->body[i].shape != OB_SHAPE_PLANE)
			continue;
		if (s->body[i].friction > 0)
			return false;
		along = ob_madd(along, -ob_dot(along, normal), normal);
	}
	double left = ob_norm(along);
	*direction = ob_scale(along, 1 / left);
	return left > 1e-3;
}

static bool boost(const random_scene *s, uint64_t *seed, view *o)
{
	ob_vec3 along;
	if (!along_planes(s, seed, &along))
		return false;
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].path.frequency > 0)
			return false;
	o->boost = ob_scale(along, pow(10, within(seed, 0, 2)));
	return true;
}

static bool lift(const random_scene *s, uint64_t *seed, view *o)
{
	ob_vec3 along;
	if (!along_planes(s, seed, &along))
		return false;
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].driven)
			return false;
	o->lift = ob_scale(along, pow(10, within(seed, -1, 1)));
	return true;
}

static bool reframe(const random_scene *s, uint64_t *seed, view *o)
{
	o->frame = random_attitude(seed);
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].shape == OB_SHAPE_HULL)
			return true;
	return false;
}

static void reorder(const random_scene *s, uint64_t *seed, view *o)
{
	for (uint32_t i = s->bodies; i-- > 1;) {
		uint32_t k = (uint32_t)((i + 1) * uniform(seed)), was = o->id[i];
		o->id[i] = o->id[k];
		o->id[k] = was;
	}
}

// Rescales by powers of four, so that no number is rounded. Gravity stays.
static void rescale(uint64_t *seed, view *o)
{
	int k = (int)within(seed, 1, 4);
	double up = uniform(seed) < .5 ? 1 : -1;
	o->length = exp2(2 * k * up);
	o->time = exp2(k * up);
	o->mass = exp2((int)within(seed, -9, 10));
}

static bool make_view(relation_id r, const random_scene *s, uint64_t *seed, view *o)
{
	switch (r) {
	case RELATION_MIRRORED:
		o->mirror = true;
		if (uniform(seed) < .5)
			turn(s, seed, o);
		return true;
	case RELATION_TURNED:
		turn(s, seed, o);
		return true;
	case RELATION_TILTED:
		o->turn = random_attitude(seed);
		return !scene_is_closed(s);
	case RELATION_MOVED:
		o->shift = ob_scale(random_direction(seed), pow(10, within(seed, 0, 3)));
		return true;
	case RELATION_BOOSTED:
		return boost(s, seed, o);
	case RELATION_LIFTED:
		return lift(s, seed, o);
	case RELATION_REFRAMED:
		return reframe(s, seed, o);
	case RELATION_REORDERED:
		reorder(s, seed, o);
		return s->bodies > 1;
	case RELATION_RESCALED:
		rescale(seed, o);
		return true;
	default:
		return true;
	}
}

// Adds a distant rotating box, which falls in scenes with gravity.
static void add_far_body(random_scene *s, uint64_t *seed)
{
	scene_body b = { .shape = OB_SHAPE_BOX, .size = { .1, .2, .3 }, .mass = 1, .friction = .5, .restitution = .5 };
	b.state.pose.q = ob_quat_identity();
	b.state.pose.p = ob_madd(ob_scale(random_direction(seed), 500), 2000, vertical(s));
	b.state.w = random_vector(seed, 3);
	s->body[s->bodies++] = b;
}

// Puts a box on the face of a box, or a sphere on a sphere, where "up" leaves it; it moves along with the surface.
static void add_pebble(random_scene *s, uint32_t on, ob_vec3 up)
{
	const scene_body *o = &s->body[on];
	const bool box = o->shape == OB_SHAPE_BOX;
	const ob_mat3 r = ob_quat_matrix(o->state.pose.q);
	const ob_vec3 way = ob_rotate_back(&r, up);
	const double d[3] = { way.x, way.y, way.z }, half[3] = { o->size.x, o->size.y, o->size.z };
	const double size = pebble_size * (box ? fmin(fmin(half[0], half[1]), half[2]) : o->size.x);
	ob_vec3 from = ob_scale(up, o->size.x + size);
	if (box) {
		int face = 0;
		for (int i = 1; i < 3; i++)
			face = half[i] * fabs(d[face]) < half[face] * fabs(d[i]) ? i : face;
		from = ob_madd(ob_scale(up, half[face] / fabs(d[face])), copysign(size, d[face]), ob_column(&r, face));
	}
	scene_body b = *o;
	b.size = ob_scale(ob_v3(1, box, box), size);
	b.mass = pebble_mass * o->mass;
	b.restitution = 0;
	b.pushed = false;
	b.state.pose.p = ob_add(o->state.pose.p, from);
	b.state.v = ob_add(o->state.v, ob_cross(o->state.w, from));
	s->body[s->bodies++] = b;
}

// Returns the highest body that moves and has one of these shapes (bits); SCENE_BODIES: there is none.
static uint32_t highest(const random_scene *s, ob_vec3 up, unsigned shapes)
{
	uint32_t top = SCENE_BODIES;
	for (uint32_t i = 0; i < s->bodies; i++) {
		const scene_body *b = &s->body[i];
		if (b->mass > 0 && shapes >> b->shape & 1 &&
		    (top == SCENE_BODIES || ob_dot(up, b->state.pose.p) > ob_dot(up, s->body[top].state.pose.p)))
			top = i;
	}
	return top;
}

static ob_vec3 up_of(const random_scene *s, uint64_t *seed)
{
	return ob_norm(s->run.gravity) > 0 ? vertical(s) : random_direction(seed);
}

// Adds so many pebbles, one on the other, to the highest body of all. Returns false if there is no room, or none to lie on.
static bool add_pebbles(random_scene *s, uint32_t pebbles, uint64_t *seed)
{
	const ob_vec3 up = up_of(s, seed);
	uint32_t on = highest(s, up, 1u << OB_SHAPE_BOX | 1u << OB_SHAPE_SPHERE);
	if (on == SCENE_BODIES || s->bodies + pebbles > SCENE_BODIES)
		return false;
	for (uint32_t i = 0; i < pebbles; i++, on = s->bodies - 1)
		add_pebble(s, on, up);
	return true;
}

static bool add_fixed_pebble(random_scene *s, uint64_t *seed)
{
	const uint32_t on = highest(s, up_of(s, &(uint64_t){ *seed }), 1u << OB_SHAPE_BOX | 1u << OB_SHAPE_SPHERE);
	if (!add_pebbles(s, 1, seed))
		return false;
	s->body[s->bodies - 1].fixed = on + 1;
	s->body[s->bodies - 1].passes = true;
	return true;
}

// Cuts the highest box across its longest edges. whole: centre of the box, from that of the piece that keeps its number.
static bool cut(random_scene *s, uint64_t *seed, uint32_t *number, ob_vec3 *whole)
{
	const uint32_t i = *number = highest(s, up_of(s, seed), 1u << OB_SHAPE_BOX);
	if (i == SCENE_BODIES || s->bodies == SCENE_BODIES || s->body[i].pushed)
		return false;
	scene_body *a = &s->body[i], *b = &s->body[s->bodies++];
	double *half = &a->size.x;
	const int along = half[0] >= half[1] && half[0] >= half[2] ? 0 : half[1] >= half[2] ? 1 : 2;
	const ob_mat3 r = ob_quat_matrix(a->state.pose.q);
	const ob_vec3 way = ob_scale(ob_column(&r, along), .5 * half[along]);
	(&whole->x)[along] = -.5 * half[along];
	half[along] *= .5, a->mass *= .5;
	*b = *a;
	b->fixed = i + 1;
	for (int k = 0; k < 2; k++) {
		ob_state *x = k ? &b->state : &a->state;
		const ob_vec3 off = ob_scale(way, k ? -1 : 1);
		x->pose.p = ob_add(x->pose.p, off);
		x->v = ob_add(x->v, ob_cross(x->w, off));
	}
	return true;
}

// True if the two bodies do not move against each other.
static bool stay_together(const original *o, uint32_t i, uint32_t k)
{
	const ob_state *a = &o->scene->body[i].state, *b = &o->scene->body[k].state;
	for (int n = 0; n < PLAY_SAMPLES; n++) {
		const ob_state *x = &o->base.at[n][i], *y = &o->base.at[n][k];
		if (ob_norm(ob_sub(x->pose.p, a->pose.p)) > tolerance ||
		    ob_norm(ob_sub(y->pose.p, b->pose.p)) > tolerance)
			return false;
	}
	return true;
}

// Fixes the highest body to the one below it, if both stay where they are, and so does their twin.
static bool bolt(const original *o, random_scene *s, uint64_t *seed)
{
	const unsigned any = ~0u;
	const ob_vec3 up = up_of(s, seed);
	const uint32_t top = highest(s, up, any);
	random_scene rest = *s;
	if (top == SCENE_BODIES || ob_norm(s->run.gravity) == 0 || o->samples < PLAY_SAMPLES)
		return false;
	rest.body[top].mass = 0;
	const uint32_t below = highest(&rest, up, any);
	if (below == SCENE_BODIES || !stay_together(o, top, below))
		return false;
	const ob_vec3 apart = ob_sub(s->body[top].state.pose.p, s->body[below].state.pose.p);
	const double reach = ob_shape_radius(s->body[top].shape, s->body[top].size) +
			     ob_shape_radius(s->body[below].shape, s->body[below].size);
	s->body[top].fixed = below + 1;
	return ob_norm(apart) <= reach;
}

// Compares the original's bodies with those of the same scene with more, or with joints. cut: one of which a piece is
// left, with its centre from that of the piece; SCENE_BODIES: none.
static void judge_more(const original *o, const random_scene *more, uint32_t cut, ob_vec3 whole, uint64_t steps,
		       judged *j)
{
	played other;
	const view same = same_view(o->scene);
	play(more, 0, steps, &other);
	for (int k = 0; k < PLAY_SAMPLES && cut < SCENE_BODIES; k++) {
		ob_pose *piece = &other.at[k][cut].pose;
		const ob_mat3 r = ob_quat_matrix(piece->q);
		piece->p = ob_add(piece->p, ob_rotate(&r, whole));
	}
	memcpy(j->why, other.why, sizeof j->why);
	j->applies = other.depth < 1e-6; // they overlap nothing
	j->counted = o->samples == PLAY_SAMPLES;
	j->limit = joined_limit;
	for (int k = 0; k < o->samples; k++) {
		const double d = difference(o->scene, &o->base, &other, &same, k, steps);
		if (d > joined_limit && j->error <= joined_limit)
			j->when = sample_time(o->scene, k, steps);
		j->error = fmax(j->error, d);
	}
}

static void judge_bits(const original *o, const random_scene *s, uint32_t workers, uint64_t steps, judged *j)
{
	played other;
	play(s, workers, steps, &other);
	memcpy(j->why, other.why, sizeof j->why);
	j->counted = true;
	j->error = other.failed;
	for (int k = 0; k < PLAY_SAMPLES; k++)
		for (uint32_t i = 0; i < o->scene->bodies; i++)
			if (memcmp(&o->base.at[k][i], &other.at[k][i], sizeof other.at[k][i]) != 0)
				j->error = 1;
}

static void judge_view(const original *o, const view *v, uint64_t steps, judged *j)
{
	played other;
	random_scene s = see_scene(v, o->scene);
	play(&s, 0, steps, &other);
	memcpy(j->why, other.why, sizeof j->why);
	j->counted = o->samples == PLAY_SAMPLES;
	for (int k = 0; k < o->samples; k++) {
		double d = difference(o->scene, &o->base, &other, v, k, steps);
		if (d > tolerance && j->error <= tolerance)
			j->when = sample_time(o->scene, k, steps);
		j->error = fmax(j->error, d);
	}
	j->limit = tolerance;
}

// Substeps 8, 16, 32: change by the second doubling over change by the first.
static void judge_refined(const original *o, uint64_t steps, judged *j)
{
	played run[3];
	const view same = same_view(o->scene);
	double change[2] = { 0 };
	for (int k = 0; k < 3; k++) {
		random_scene s = *o->scene;
		s.run.tolerance = 0;
		s.run.substeps = 8u << k;
		play(&s, 0, steps, &run[k]);
	}
	for (int k = 0; k < o->samples; k++)
		for (int i = 0; i < 2; i++)
			change[i] = fmax(change[i], difference(o->scene, &run[i], &run[i + 1], &same, k, steps));
	j->counted = o->samples == PLAY_SAMPLES;
	j->error = change[1] <= tolerance ? 0 : change[1] / change[0];
	j->limit = 1;
}

// True if energy may come from outside.
static bool is_worked_on(const random_scene *s)
{
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].driven || s->body[i].pushed || ob_norm2(s->body[i].running) > 0)
			return true;
	return false;
}

static double limit_of(relation_id r, const original *o)
{
	return r == RELATION_MOMENTUM || (r == RELATION_SPIN && !o->base.touched) ? 1e-12 : 1e-9;
}

enum { FIRST_RELATIONS = 14 }; // further relations do not change the numbers drawn for these

static judged judge(relation_id r, const original *o, uint64_t seed, uint64_t steps)
{
	judged j = { .applies = true, .counted = true };
	view v = same_view(o->scene);
	random_scene more = *o->scene;
	uint32_t piece = SCENE_BODIES;
	ob_vec3 whole = { 0, 0, 0 };
	seed = seed * FIRST_RELATIONS + r % FIRST_RELATIONS + ((uint64_t)(r / FIRST_RELATIONS) << 32);
	switch (r) {
	case RELATION_AGAIN:
	case RELATION_WORKERS:
		judge_bits(o, o->scene, r == RELATION_AGAIN ? 0 : 3, steps, &j);
		break;
	case RELATION_FAR:
		j.applies = more.bodies < SCENE_BODIES;
		if (j.applies) {
			add_far_body(&more, &seed);
			judge_bits(o, &more, 0, steps, &j);
		}
		break;
	case RELATION_PEBBLE:
	case RELATION_NEIGHBOUR:
	case RELATION_IDLE:
	case RELATION_CUT:
	case RELATION_BOLTED:
		j.applies = r == RELATION_IDLE     ? add_fixed_pebble(&more, &seed)
			    : r == RELATION_CUT    ? cut(&more, &seed, &piece, &whole)
			    : r == RELATION_BOLTED ? bolt(o, &more, &seed)
						   : add_pebbles(&more, r == RELATION_PEBBLE ? 1 : 2, &seed);
		if (j.applies)
			judge_more(o, &more, piece, whole, steps, &j);
		break;
	case RELATION_REFINED:
		judge_refined(o, steps, &j);
		break;
	case RELATION_MOMENTUM:
	case RELATION_SPIN:
	case RELATION_ENERGY:
		j.applies = r == RELATION_ENERGY ? !is_worked_on(o->scene) : scene_is_closed(o->scene);
		j.error = r == RELATION_ENERGY ? o->base.energy : r == RELATION_SPIN ? o->base.spin : o->base.momentum;
		j.limit = limit_of(r, o);
		break;
	default:
		j.applies = make_view(r, o->scene, &seed, &v);
		if (j.applies)
			judge_view(o, &v, steps, &j);
	}
	return j;
}

judged relation_judge(relation_id r, const original *o, uint64_t seed, uint64_t steps)
{
	const judged j = judge(r, o, seed, steps);
	if (!relation_fails(&j))
		return j;
	original doubted = *o;
	watch_twins(&doubted, TWINS, TWINS_IN_DOUBT, steps);
	return judge(r, &doubted, seed, steps);
}

bool relation_fails(const judged *j)
{
	return j->applies && !(j->error <= j->limit);
}
