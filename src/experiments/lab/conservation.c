#include "lab/conservation.h"

const ob_conserved_kind ob_conserved_kinds[OB_CONSERVED] = {
	[OB_CONSERVED_MOMENTUM] = { "momentum", 1e-12 },
	[OB_CONSERVED_ANGULAR] = { "angular momentum", 1e-9 },
	[OB_CONSERVED_ENERGY] = { "gain of energy, net", 1e-9 },
};

static bool is_fixed(const ob_passport *p)
{
	return p->flags & OB_OBJECT_PRESCRIBED || !(p->mass > 0);
}

ob_conservation ob_conservation_begin(const ob_world *w)
{
	ob_conservation c = { .world = w, .closed = ob_norm2(w->gravity) == 0, .lowest = INFINITY };
	double mass = 0;
	for (uint32_t id = 0; id < w->objects; id++) {
		const ob_passport *p = &w->passport[id];
		c.closed &= !is_fixed(p) && ob_norm2(p->force) == 0;
		if (is_fixed(p))
			continue;
		c.centre = ob_madd(c.centre, p->mass, w->state[id].pose.p);
		mass += p->mass;
	}
	c.centre = ob_scale(c.centre, mass > 0 ? 1 / mass : 0);
	c.driven = ob_world_drives(w) != OB_WORLD_DRIVES_NOTHING; // driven bodies may add energy
	for (uint32_t i = 0; i < w->joints; i++) {
		c.driven |= w->joint[i].flags & OB_JOINT_DRIVEN; // motors add energy, springs keep it
		c.closed &= w->joint[i].object[1] != OB_JOINT_WORLD;
	}
	c.worst[OB_CONSERVED_ENERGY] = c.driven ? NAN : 0;
	c.worst[OB_CONSERVED_MOMENTUM] = c.worst[OB_CONSERVED_ANGULAR] = c.closed ? 0 : NAN;
	return c;
}

// Sums over the bodies of a snapshot.
typedef struct sums {
	ob_vec3 momentum, angular;
	double energy; // J, including gravity's and constant forces'
	double scale[OB_CONSERVED];
} sums;

static void add_body(sums *s, const ob_conservation *c, const ob_passport *p, const ob_state *b)
{
	ob_mat3 r = ob_quat_matrix(b->pose.q);
	ob_vec3 w = ob_rotate_back(&r, b->w), arm = ob_sub(b->pose.p, c->centre);
	ob_vec3 spin = ob_rotate(&r, ob_v3(p->inertia.x * w.x, p->inertia.y * w.y, p->inertia.z * w.z));
	double radius = ob_shape_radius(p->shape, p->size), m = p->mass, speed = ob_norm(b->v);
	double kinetic = .5 * m * speed * speed + .5 * ob_dot(b->w, spin);
	ob_vec3 pull = ob_madd(p->force, m, c->world->gravity);
	s->momentum = ob_madd(s->momentum, m, b->v);
	s->angular = ob_add(ob_madd(s->angular, m, ob_cross(arm, b->v)), spin);
	s->energy += kinetic - ob_dot(pull, arm);
	s->scale[OB_CONSERVED_MOMENTUM] += m * speed;
	s->scale[OB_CONSERVED_ANGULAR] += m * speed * radius + ob_norm(spin);
	s->scale[OB_CONSERVED_ENERGY] += kinetic + ob_norm(pull) * radius;
}

static void keep(double *worst, double value)
{
	if (!(value <= *worst))
		*worst = isnan(value) ? INFINITY : value;
}

void ob_conservation_look(ob_conservation *c, const ob_snapshot *now, double recovered)
{
	sums s = { 0 };
	for (uint32_t id = 0; id < c->world->objects; id++) {
		ob_state b = ob_snapshot_state(now, id);
		if (!is_fixed(&c->world->passport[id]))
			add_body(&s, c, &c->world->passport[id], &b);
	}
	if (!c->begun) {
		c->begun = true;
		c->momentum = s.momentum;
		c->angular = s.angular;
	}
	for (int i = 0; i < OB_CONSERVED; i++)
		c->scale[i] = fmax(c->scale[i], s.scale[i]);
	double net = s.energy - recovered, *scale = c->scale;
	c->lowest = fmin(c->lowest, net);
	if (scale[OB_CONSERVED_ENERGY] > 0 && !c->driven)
		keep(&c->worst[OB_CONSERVED_ENERGY], (net - c->lowest) / scale[OB_CONSERVED_ENERGY]);
	if (!c->closed)
		return;
	if (scale[OB_CONSERVED_MOMENTUM] > 0)
		keep(&c->worst[OB_CONSERVED_MOMENTUM],
		     ob_norm(ob_sub(s.momentum, c->momentum)) / scale[OB_CONSERVED_MOMENTUM]);
	if (scale[OB_CONSERVED_ANGULAR] > 0)
		keep(&c->worst[OB_CONSERVED_ANGULAR],
		     ob_norm(ob_sub(s.angular, c->angular)) / scale[OB_CONSERVED_ANGULAR]);
}

void ob_conservation_keep(double worst[OB_CONSERVED], const double other[OB_CONSERVED])
{
	for (int i = 0; i < OB_CONSERVED; i++)
		if (isnan(worst[i]) || other[i] > worst[i])
			worst[i] = other[i];
}
