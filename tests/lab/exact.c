#include "exact.h"

#include "reference/mechanics.h"
#include "reference/pivot.h"
#include "reference/plate.h"

static bool is_static(const ob_world *w, uint32_t id)
{
	return w->passport[id].flags & OB_OBJECT_PRESCRIBED;
}

ob_state exact_rest(const ob_world *w, uint32_t id, double t)
{
	return w->state[id];
}

ob_state exact_flight(const ob_world *w, uint32_t id, double t)
{
	const ob_passport *p = &w->passport[id];
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	ob_vec3 a = ob_madd(w->gravity, 1 / p->mass, p->force);
	ob_rotate_free(s.pose.q, s.w, p->inertia, t, &s.pose.q, &s.w);
	s.pose.p = ob_madd(ob_madd(s.pose.p, t, s.v), .5 * t * t, a);
	s.v = ob_madd(s.v, t, a);
	return s;
}

ob_state exact_bounces(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	double g = -w->gravity.z, e = w->passport[id].restitution, radius = w->passport[id].size.x;
	double height = s.pose.p.z - radius, v = 0, since = t, from = height;
	for (int k = 1; ob_reference_impact_time(height, g, e, k) < t; k++) {
		from = 0;
		since = t - ob_reference_impact_time(height, g, e, k);
		v = sqrt(2 * g * ob_reference_apex(height, e, k));
	}
	s.v.z = v - g * since;
	s.pose.p.z = radius + from + v * since - .5 * g * since * since;
	return s;
}

ob_state exact_meeting(const ob_world *w, uint32_t id, double t)
{
	uint32_t first = id & ~1u;
	const ob_passport *a = &w->passport[first], *b = a + 1;
	const ob_state *sa = &w->state[first], *sb = sa + 1;
	ob_reference_pair before = { sa->v.x, sb->v.x };
	ob_reference_pair after = ob_reference_impact(a->mass, b->mass, before, a->restitution);
	double meets = (sb->pose.p.x - sa->pose.p.x - a->size.x - b->size.x) / (before.a - before.b);
	ob_state s = w->state[id];
	s.pose.p.x += s.v.x * fmin(t, meets);
	if (t > meets) {
		s.v.x = id == first ? after.a : after.b;
		s.pose.p.x += s.v.x * (t - meets);
	}
	return s;
}

ob_state exact_cradle(const ob_world *w, uint32_t id, double t)
{
	uint32_t incoming = 0;
	while (w->state[incoming].v.x > 0)
		incoming++;
	double v[5], meets = w->state[incoming].pose.p.x - w->state[incoming - 1].pose.p.x - 1;
	ob_reference_cradle(5, (int)incoming, 1, v);
	ob_state s = w->state[id];
	s.pose.p.x += s.v.x * fmin(t, meets) + v[id] * fmax(t - meets, 0);
	if (t > meets)
		s.v.x = v[id];
	return s;
}

static ob_state accelerated(ob_state s, ob_vec3 a, double t)
{
	s.pose.p = ob_madd(s.pose.p, .5 * t * t, a);
	s.v = ob_scale(a, t);
	return s;
}

ob_state exact_push(const ob_world *w, uint32_t id, double t)
{
	ob_vec3 force = w->passport[1].force;
	double size = ob_norm(force);
	ob_reference_rolling r = ob_reference_push(size, .4, 10, 1, 25, -w->gravity.z);
	return accelerated(w->state[id], ob_scale(force, (id ? id == 1 ? r.box_a : r.ball_a : 0) / size), t);
}

ob_state exact_slide(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	ob_mat3 r = ob_quat_matrix(w->state[0].pose.q);
	ob_vec3 down = ob_column(&r, 0);
	double angle = asin(-down.z), g = -w->gravity.z, mu = w->passport[id].friction;
	bool ball = w->passport[id].shape == OB_SHAPE_SPHERE;
	double a = ball ? ob_reference_ball_incline(g, angle, mu) : ob_reference_incline(g, angle, mu);
	return accelerated(s, ob_scale(down, a), t);
}

ob_state exact_stop(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	double g = -w->gravity.z, mu = w->passport[id].friction, v = ob_norm(s.v);
	double since = fmin(t, ob_reference_stop_time(v, mu, g));
	s.pose.p = ob_madd(s.pose.p, since - .5 * mu * g * since * since / v, s.v);
	s.v = ob_scale(s.v, 1 - mu * g * since / v);
	return s;
}

ob_state exact_slip(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	ob_reference_roll r = ob_reference_slip_to_roll(s.v.x, w->passport[id].friction, -w->gravity.z, t);
	s.pose.p.x += r.distance;
	s.v.x = r.speed;
	s.w.y = r.surface / w->passport[id].size.x;
	return s;
}

ob_state exact_halt(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	double speed = fabs(s.v.x);
	if (is_static(w, id))
		return s;
	s.pose.p = ob_madd(s.pose.p, fmin(t, 2.5 / speed), s.v);
	if (t > 2.5 / speed)
		s.v = ob_v3(0, 0, 0);
	return s;
}

// At rest from the first: only the final state is read.
ob_state exact_plate(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	const ob_passport *p = &w->passport[id];
	if (is_static(w, id))
		return s;
	ob_reference_plate plate = { p->shape == OB_SHAPE_CYLINDER, p->size.x, p->size.y, p->friction, -w->gravity.z };
	ob_reference_plate_state start = { .vx = s.v.x, .vy = s.v.y, .w = s.w.z };
	start.angle = 2 * atan2(s.pose.q.z, s.pose.q.w);
	if (t > 1.99) { // earlier ones would take time, and are not read
		ob_reference_plate_state end = ob_reference_plate_slide(&plate, start, t);
		s.pose.p = ob_add(s.pose.p, ob_v3(end.x, end.y, 0));
		s.pose.q = ob_quat_turn(s.pose.q, ob_v3(0, 0, end.angle - start.angle));
	}
	s.v = s.w = ob_v3(0, 0, 0);
	return s;
}

ob_state exact_drop(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	double g = -w->gravity.z, e = w->passport[id].restitution, v = 0, since = t, from = 1;
	if (e < 1 && t > ob_reference_impact_time(1, g, e, 200)) {
		s.pose.p.z -= 1;
		return s;
	}
	for (int k = 1; ob_reference_impact_time(1, g, e, k) < t; k++) {
		from = 0;
		since = t - ob_reference_impact_time(1, g, e, k);
		v = sqrt(2 * g * ob_reference_apex(1, e, k));
	}
	s.v.z = v - g * since;
	s.pose.p.z += from - 1 + v * since - .5 * g * since * since;
	return s;
}

ob_state exact_disk(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	ob_vec3 size = w->passport[id].size;
	double tilt = 2 * atan2(s.pose.q.y, s.pose.q.w);
	double turn = ob_reference_disk_precession(size.x, size.y, tilt, -w->gravity.z);
	double spin = ob_reference_disk_spin(size.x, size.y, tilt, -w->gravity.z), c = cos(turn * t), n = sin(turn * t);
	ob_quat own = ob_quat_mul(s.pose.q, (ob_quat){ cos(.5 * spin * t), 0, 0, sin(.5 * spin * t) });
	s.pose.q = ob_quat_turn(own, ob_v3(0, 0, turn * t));
	s.w = ob_v3(c * s.w.x - n * s.w.y, n * s.w.x + c * s.w.y, s.w.z);
	return s;
}

ob_state exact_roll(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	s.pose.p = ob_madd(s.pose.p, t, s.v);
	s.pose.q = ob_quat_turn(s.pose.q, ob_scale(s.w, t));
	return s;
}

ob_state exact_pull(const ob_world *w, uint32_t id, double t)
{
	const ob_passport *p = &w->passport[id];
	if (is_static(w, id))
		return w->state[id];
	double size = ob_norm(p->force), a = size / p->mass + p->friction * w->gravity.z;
	return accelerated(w->state[id], ob_scale(p->force, a / size), t);
}

ob_state exact_round(const ob_world *w, uint32_t id, double t)
{
	const ob_passport *p = &w->passport[id];
	if (is_static(w, id))
		return w->state[id];
	ob_mat3 r = ob_quat_matrix(w->state[0].pose.q);
	ob_vec3 down = ob_column(&r, 0);
	double moment = p->inertia.z / (p->mass * p->size.x * p->size.x);
	return accelerated(w->state[id],
			   ob_scale(down, ob_reference_round_incline(-w->gravity.z, asin(-down.z), moment)), t);
}

ob_state exact_shaken(const ob_world *w, uint32_t id, double t)
{
	const ob_path *path = ob_world_path(w, id - id % 2);
	const double f = path->frequency;
	ob_state s = w->state[id];
	if (is_static(w, id)) {
		s.pose.p = ob_madd(s.pose.p, sin(f * t) / f, s.v);
		s.v = ob_scale(s.v, cos(f * t));
		return s;
	}
	const ob_reference_shaken b = ob_reference_shaken_block(ob_norm(w->state[id - 1].v) / f, f,
								w->passport[id].friction, -w->gravity.z, 0, t);
	s.pose.p.x += b.x;
	s.v.x = b.v;
	return s;
}

ob_state exact_ridden(const ob_world *w, uint32_t id, double t)
{
	const ob_path *path = ob_world_path(w, 0);
	const double f = path->frequency;
	ob_state s = w->state[id];
	s.pose.p = ob_madd(s.pose.p, (1 - cos(f * t)) / (f * f), path->a);
	s.v = ob_scale(path->a, sin(f * t) / f);
	return s;
}

ob_state exact_belt(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	if (is_static(w, id))
		return s;
	const double speed = w->passport[id - 1].surface_velocity.x, a = w->passport[id].friction * -w->gravity.z,
		     since = fmin(t, speed / a);
	s.pose.p.x += .5 * a * since * since + speed * (t - since);
	s.v.x = a * since;
	return s;
}

ob_state exact_turntable(const ob_world *w, uint32_t id, double t)
{
	ob_state s = w->state[id];
	const ob_vec3 turn = ob_v3(0, 0, w->state[id - id % 2].w.z * t), axis = w->state[id - id % 2].pose.p;
	s.pose.q = ob_quat_turn(s.pose.q, turn);
	if (is_static(w, id))
		return s;
	const ob_mat3 r = ob_quat_matrix(ob_quat_turn(ob_quat_identity(), turn));
	const double rate = s.w.z, radius = s.pose.p.x - axis.x;
	if (radius > ob_reference_turntable_radius(rate, w->passport[id].friction, -w->gravity.z)) {
		s.pose.p = ob_madd(s.pose.p, t, s.v);
		return s;
	}
	s.pose.p = ob_add(axis, ob_rotate(&r, ob_sub(s.pose.p, axis)));
	s.v = ob_rotate(&r, s.v);
	return s;
}
