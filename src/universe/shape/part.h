// Round parts of compounds: each has a shape, a size and a frame of its own in the frame of its body. Pure functions,
// thread-safe.
#ifndef OB_SHAPE_PART_H
#define OB_SHAPE_PART_H

#include <ob/hull.h>
#include <ob/motion.h>

// True for a round part; NULL: none.
static inline bool ob_part_is_round(const ob_hull *part)
{
	return part && part->is_part && part->round;
}

// Shape with which a part of a body of this shape collides.
static inline ob_shape ob_part_shape(ob_shape body, const ob_hull *part)
{
	return ob_part_is_round(part) ? (ob_shape)part->round : body;
}

// Moves the frame of a body to that of its round part.
static inline void ob_part_enter(const ob_hull *part, ob_vec3 *p, ob_mat3 *r)
{
	const ob_mat3 own = ob_quat_matrix(part->frame), body = *r;
	*p = ob_add(*p, ob_rotate(&body, part->centre));
	for (int c = 0; c < 3; c++) {
		const ob_vec3 axis = ob_rotate(&body, ob_column(&own, c));
		r->m[0][c] = axis.x, r->m[1][c] = axis.y, r->m[2][c] = axis.z;
	}
}

#endif
