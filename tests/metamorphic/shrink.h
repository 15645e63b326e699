// Simplifies a scene that violates a relation, as long as it still does.
#ifndef OB_TESTS_METAMORPHIC_SHRINK_H
#define OB_TESTS_METAMORPHIC_SHRINK_H

#include "relation.h"

// Fewer bodies, no velocities, plain attitudes and materials, round numbers.
random_scene shrink_scene(const random_scene *s, relation_id r, uint64_t seed, uint64_t steps);

#endif
