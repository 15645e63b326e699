#include "shrink.h"

typedef struct shrinking {
	random_scene scene;
	relation_id relation;
	uint64_t seed, steps;
	int left; // number of scenes that may still be tried
} shrinking;

// Keeps the simpler scene if it violates the relation as well.
static bool try(shrinking *p, const random_scene *simpler)
{
	if (p->left-- <= 0)
		return false;
	original o = relation_original(simpler, p->steps);
	if (!o.valid)
		return false;
	judged j = relation_judge(p->relation, &o, p->seed, p->steps);
	if (!relation_fails(&j))
		return false;
	p->scene = *simpler;
	return true;
}

static bool drop_bodies(shrinking *p)
{
	bool any = false;
	for (uint32_t i = 0; i < p->scene.bodies && p->scene.bodies > 1;) {
		random_scene s = p->scene;
		s.bodies--;
		for (uint32_t k = i; k < s.bodies; k++)
			s.body[k] = s.body[k + 1];
		if (try(p, &s))
			any = true;
		else
			i++;
	}
	return any;
}

// Rounds to so many digits.
static double rounded(double x, int digits)
{
	char text[40];
	double y;
	snprintf(text, sizeof text, "%.*e", digits - 1, x);
	return sscanf(text, "%lf", &y) == 1 ? y : x;
}

static ob_vec3 rounded_vector(ob_vec3 x, int digits)
{
	return ob_v3(rounded(x.x, digits), rounded(x.y, digits), rounded(x.z, digits));
}

static ob_quat rounded_attitude(ob_quat q, int digits)
{
	return ob_quat_normalize(
		(ob_quat){ rounded(q.w, digits), rounded(q.x, digits), rounded(q.y, digits), rounded(q.z, digits) });
}

enum { SIMPLER = 13 };

// Simplifies a body in the i-th way; returns false if that changes nothing.
static bool simplify(scene_body *b, int way)
{
	const scene_body was = *b;
	switch (way) {
	case 0:
		b->state.v = ob_v3(0, 0, 0);
		return ob_norm2(was.state.v) > 0;
	case 1:
		b->state.w = ob_v3(0, 0, 0);
		return ob_norm2(was.state.w) > 0;
	case 2:
		b->state.pose.q = ob_quat_identity();
		return was.state.pose.q.w != 1;
	case 3:
		b->restitution = 0;
		return was.restitution != 0;
	case 4:
		b->friction = 0;
		return was.friction != 0;
	case 5:
		b->restitution = 1;
		return was.restitution != 1 && was.restitution != 0;
	case 6:
		b->shape = OB_SHAPE_SPHERE;
		return was.shape != OB_SHAPE_PLANE && was.shape != OB_SHAPE_SPHERE && was.mass > 0;
	case 7:
		b->mass = 1;
		return was.mass != 1 && was.mass > 0;
	case 8:
		b->size = ob_v3(was.size.x, was.size.x, was.size.x);
		return was.shape != OB_SHAPE_PLANE && was.shape != OB_SHAPE_HULL &&
		       (was.size.y != was.size.x || was.size.z != was.size.x);
	case 9:
		b->shape = OB_SHAPE_BOX;
		return was.shape == OB_SHAPE_HULL;
	case 10:
		b->pushed = false;
		return was.pushed;
	case 11:
		b->running = ob_v3(0, 0, 0);
		return ob_norm2(was.running) > 0;
	default:
		b->driven = false;
		b->state.v = b->state.w = ob_v3(0, 0, 0);
		b->path = (ob_path){ 0 };
		return was.driven;
	}
}

static bool simplify_bodies(shrinking *p)
{
	bool any = false;
	for (uint32_t i = 0; i < p->scene.bodies; i++)
		for (int way = 0; way < SIMPLER; way++) {
			random_scene s = p->scene;
			any |= simplify(&s.body[i], way) && try(p, &s);
		}
	return any;
}

static void round_body(scene_body *b, int digits)
{
	for (uint32_t i = 0; i < b->points; i++)
		b->point[i] = rounded_vector(b->point[i], digits);
	if (b->shape != OB_SHAPE_HULL)
		b->size = rounded_vector(b->size, digits);
	else if (!scene_make_hull(b))
		b->mass = NAN; // an invalid scene
	b->mass = rounded(b->mass, digits);
	b->friction = rounded(b->friction, digits);
	b->restitution = rounded(b->restitution, digits);
	b->state.pose.p = rounded_vector(b->state.pose.p, digits);
	if (b->state.pose.q.w != 1)
		b->state.pose.q = rounded_attitude(b->state.pose.q, digits);
	b->state.v = rounded_vector(b->state.v, digits);
	b->state.w = rounded_vector(b->state.w, digits);
}

static void round_numbers(shrinking *p)
{
	for (uint32_t i = 0; i < p->scene.bodies; i++)
		for (int digits = 1; digits <= 4; digits++) {
			random_scene s = p->scene;
			round_body(&s.body[i], digits);
			if (try(p, &s))
				break;
		}
}

random_scene shrink_scene(const random_scene *s, relation_id r, uint64_t seed, uint64_t steps)
{
	shrinking p = { *s, r, seed, steps, 400 };
	bool any = true;
	while (any) {
		any = drop_bodies(&p);
		any |= simplify_bodies(&p);
	}
	round_numbers(&p);
	return p.scene;
}
