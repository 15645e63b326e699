#include "engine/world.h"

#include <math.h>
#include <stdlib.h>

ob_world_drive ob_world_drives(const ob_world *w)
{
	ob_world_drive drives = OB_WORLD_DRIVES_NOTHING;
	for (uint32_t i = 0; i < w->objects; i++) {
		const ob_passport *p = &w->passport[i];
		if (p->flags & OB_OBJECT_PRESCRIBED && ob_norm2(p->surface_velocity) > 0)
			return OB_WORLD_DRIVES_SURFACES;
		if (p->flags & OB_OBJECT_KINEMATIC)
			drives = OB_WORLD_DRIVES_BODIES;
	}
	return drives;
}

const ob_path *ob_world_path(const ob_world *w, uint32_t id)
{
	for (uint32_t i = 0; i < w->paths; i++)
		if (w->path[i].id == id)
			return &w->path[i].path;
	return NULL;
}

void ob_world_finish(ob_world *w)
{
	free(w->passport);
	free(w->state);
	free(w->path);
	free(w->hull);
	free(w->joint);
	*w = (ob_world){ 0 };
}

// ---- drive

bool ob_drive_init(ob_drive *d, const ob_world *w)
{
	*d = (ob_drive){ .body = calloc(w->objects + 1, sizeof *d->body) };
	for (uint32_t id = 0; id < w->objects && d->body; id++) {
		if (!(w->passport[id].flags & OB_OBJECT_KINEMATIC))
			continue;
		const ob_path *path = ob_world_path(w, id);
		d->body[d->count++] = (struct ob_driven){
			.id = id,
			.from = w->state[id],
			.frequency = path ? path->frequency : 0,
			.a = path ? path->a : ob_v3(0, 0, 0),
		};
	}
	return d->body;
}

void ob_drive_finish(ob_drive *d)
{
	free(d->body);
}

static ob_vec3 place(const struct ob_driven *b, double t)
{
	const double f = b->frequency;
	const double along = f > 0 ? sin(f * t) / f : t, off = f > 0 ? (1 - cos(f * t)) / (f * f) : 0;
	return ob_madd(ob_madd(b->from.pose.p, along, b->from.v), off, b->a);
}

ob_state ob_drive_step(const ob_drive *d, uint32_t i, double t, double h)
{
	const struct ob_driven *b = &d->body[i];
	ob_state s = b->from;
	s.pose.p = place(b, t);
	s.pose.q = ob_quat_turn(b->from.pose.q, ob_scale(b->from.w, t));
	s.v = ob_scale(ob_sub(place(b, t + h), s.pose.p), 1 / h);
	return s;
}

// ---- joint tree

typedef struct builder {
	const ob_world *world;
	uint32_t *group; // [objects + 1], a member of each object's group, nearer to its head; last: the world's
	bool *edge; // [joints], part of the tree
	bool *placed; // [objects]
	uint32_t *joint; // the result
} builder;

static uint32_t head(const builder *b, uint32_t object)
{
	uint32_t i = object == OB_JOINT_WORLD ? b->world->objects : object;
	while (b->group[i] != i)
		i = b->group[i] = b->group[b->group[i]];
	return i;
}

static bool is_fixed(const ob_world *w, uint32_t object)
{
	return object == OB_JOINT_WORLD || w->passport[object].flags & OB_OBJECT_PRESCRIBED;
}

// Joints of lower rank are taken first: loops are hardest to close by those that move along an axis, easiest by balls.
enum { RANKS = 3 };
static int rank_of(const ob_joint_passport *j)
{
	if (j->kind == OB_JOINT_DISTANCE || j->kind == OB_JOINT_APART)
		return RANKS;
	if (j->kind == OB_JOINT_SLIDER || j->kind == OB_JOINT_UNIVERSAL || j->flags & OB_JOINT_DRIVEN)
		return 0;
	return j->kind == OB_JOINT_BALL ? 2 : 1;
}

// Takes the joints of this rank that close no loop.
static void take(builder *b, int rank)
{
	for (uint32_t i = 0; i < b->world->joints; i++) {
		const ob_joint_passport *j = &b->world->joint[i];
		const uint32_t first = head(b, j->object[0]), second = head(b, j->object[1]);
		if (rank_of(j) != rank || first == second)
			continue;
		b->group[first] = second;
		b->edge[i] = true;
	}
}

// Places all objects that joints hold to placed ones.
static void place_joints(builder *b)
{
	for (bool more = true; more;) {
		more = false;
		for (uint32_t i = 0; i < b->world->joints; i++) {
			const ob_joint_passport *j = &b->world->joint[i];
			const bool first = is_fixed(b->world, j->object[0]) || b->placed[j->object[0]],
				   second = is_fixed(b->world, j->object[1]) || b->placed[j->object[1]];
			if (!b->edge[i] || first == second)
				continue;
			const uint32_t child = j->object[first];
			b->joint[child] = i;
			b->placed[child] = more = true;
		}
	}
}

static void build(builder *b)
{
	const ob_world *w = b->world;
	for (uint32_t i = 0; i <= w->objects; i++)
		b->group[i] = i < w->objects && is_fixed(w, i) ? w->objects : i;
	for (int rank = 0; rank < RANKS; rank++)
		take(b, rank);
	for (uint32_t i = 0; i < w->objects; i++)
		b->joint[i] = OB_JOINT_WORLD;
	place_joints(b);
	for (uint32_t i = 0; i < w->objects; i++) {
		if (is_fixed(w, i) || b->placed[i])
			continue;
		b->placed[i] = true;
		place_joints(b);
	}
}

bool ob_joint_tree(const ob_world *w, uint32_t *joint)
{
	builder b = { w, calloc(w->objects + 1, sizeof *b.group), calloc(w->joints + 1, sizeof *b.edge),
		      calloc(w->objects + 1, sizeof *b.placed), joint };
	const bool fine = b.group && b.edge && b.placed;
	if (fine)
		build(&b);
	free(b.group);
	free(b.edge);
	free(b.placed);
	return fine;
}
