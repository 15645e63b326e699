// Spanning trees: each object is held once, and hangs on a static or a free one; balls are left out first.
#include <string.h>

#include "little_world.h"

#include "engine/world.h"

#include "../check.h"

static void join(little_world *l, ob_joint_kind kind, uint32_t a, uint32_t b)
{
	ob_world_join(&l->world, kind, a, b, (ob_pose){ .q = ob_quat_identity() });
}

// Objects above this one, up to the one that no joint holds.
static uint32_t depth(const little_world *l, const uint32_t *tree, uint32_t id)
{
	uint32_t steps = 0;
	while (id != OB_JOINT_WORLD && tree[id] != OB_JOINT_WORLD && steps <= l->world.objects) {
		id = ob_joint_other(&l->world.joint[tree[id]], id);
		steps++;
	}
	return steps;
}

static uint32_t count(const little_world *l, const uint32_t *tree, uint32_t joint)
{
	uint32_t sum = 0;
	for (uint32_t id = 0; id < l->world.objects; id++)
		sum += tree[id] == joint;
	return sum;
}

// A ring of five, one of them static, whose joints are listed backwards, with a ball among them.
static void ring(void)
{
	uint32_t tree[LITTLE_MOST];
	little_world *l = little_world_new();
	for (int i = 0; i < 5; i++)
		little_cube(l, i == 2 ? 0 : 1, .1, ob_v3(i, 0, 0));
	for (uint32_t i = 5; i-- > 0;)
		join(l, i == 4 ? OB_JOINT_BALL : OB_JOINT_HINGE, i, (i + 1) % 5);
	join(l, OB_JOINT_DISTANCE, 0, 3);
	CHECK(ob_joint_tree(&l->world, tree));
	CHECK(tree[2] == OB_JOINT_WORLD);
	CHECK(count(l, tree, 0) == 0 && count(l, tree, 5) == 0);
	for (uint32_t joint = 1; joint < 5; joint++)
		CHECK(count(l, tree, joint) == 1);
	CHECK(depth(l, tree, 1) == 1 && depth(l, tree, 0) == 2 && depth(l, tree, 3) == 1 && depth(l, tree, 4) == 2);
	little_world_free(l);
}

// Two that only hold each other, and one that nothing holds: the lower one is free.
static void free_ones(void)
{
	uint32_t tree[LITTLE_MOST];
	little_world *l = little_world_new();
	for (int i = 0; i < 3; i++)
		little_cube(l, 1, .1, ob_v3(i, 0, 0));
	join(l, OB_JOINT_BALL, 2, 1);
	join(l, OB_JOINT_APART, 0, 1);
	CHECK(ob_joint_tree(&l->world, tree));
	CHECK(tree[0] == OB_JOINT_WORLD && tree[1] == OB_JOINT_WORLD && tree[2] == 0);
	little_world_free(l);
}

int main(void)
{
	ring();
	free_ones();
	return check_end();
}
