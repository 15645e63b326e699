#include "engine/joint_tree.h"

#include <stdlib.h>

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
static void place(builder *b)
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
	place(b);
	for (uint32_t i = 0; i < w->objects; i++) {
		if (is_fixed(w, i) || b->placed[i])
			continue;
		b->placed[i] = true;
		place(b);
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
