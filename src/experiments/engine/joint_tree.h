// Spanning tree of a world's joints, for engines whose coordinates are the values of joints. Pure; any thread.
#ifndef OB_ENGINE_JOINT_TREE_H
#define OB_ENGINE_JOINT_TREE_H

#include "engine/world.h"

// joint: [objects], the joint that holds each object to its parent; OB_JOINT_WORLD: it is static, or free. Distances, and joints
// that would close a loop, are left out, balls before all others. false: no memory.
bool ob_joint_tree(const ob_world *w, uint32_t *joint);
// Object that holds this one by that joint: static, or the world (OB_JOINT_WORLD), or one that moves.
static inline uint32_t ob_joint_other(const ob_joint_passport *j, uint32_t object)
{
	return j->object[j->object[0] == object];
}

#endif
