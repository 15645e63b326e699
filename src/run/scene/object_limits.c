#include "scene/object_limits.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "scene/scene.h"
#include "shape/shape.h"

static bool within(const char *property, const char *unit, double least, double most, double value, ob_error *e)
{
	return (value >= least && value <= most) || // false for NaN
	       ob_fail(e, "%s: expected from %s to %s%s, got %s%s", property, ob_number_text(least).text,
		       ob_number_text(most).text, unit, ob_number_text(value).text, unit);
}

static bool within3(const char *property, const char *unit, double most, ob_vec3 v, ob_error *e)
{
	return within(property, unit, -most, most, v.x, e) && within(property, unit, -most, most, v.y, e) &&
	       within(property, unit, -most, most, v.z, e);
}

static bool is_length(double value, ob_error *e)
{
	return within("size", " m", OB_LENGTH_LEAST, OB_LENGTH_MOST, value, e);
}

// Checks the numbers of a size as they are given.
static bool check_size(const ob_passport *p, ob_error *e)
{
	const ob_shape shape = (ob_shape)p->shape;
	const double size[3] = { p->size.x, p->size.y, p->size.z };
	if (ob_shape_is(shape, OB_UNBOUNDED))
		return (p->flags & OB_OBJECT_PRESCRIBED) == OB_OBJECT_STATIC ||
		       ob_fail(e, "%s: expected to be static", ob_shape_name(shape));
	if (ob_shape_is(shape, OB_SURFACED))
		return ((p->flags & OB_OBJECT_PRESCRIBED) == OB_OBJECT_STATIC ||
			ob_fail(e, "%s: expected to be static", ob_shape_name(shape))) &&
		       within("size", " m", 0, 2 * OB_LENGTH_MOST, size[0], e) &&
		       within("size", " m", 0, 2 * OB_LENGTH_MOST, size[1], e) &&
		       within("size", " m", 0, 2 * OB_LENGTH_MOST, size[2], e);
	if (!ob_shape_is_bounded(shape))
		return ob_fail(e, "shape: expected from %d to %d, got %u", OB_SHAPE_NONE + 1, OB_SHAPE_KINDS - 1,
			       shape);
	if (ob_shape_is(shape, OB_HULLED)) // its ball, its width; the ball in it is a quarter of that, or more
		return is_length(size[0], e) && is_length(2 * size[1], e) &&
		       within("size", " m", .25 * size[1], size[0], size[2], e);
	const ob_shape_key *key = ob_shape_kind_of(shape)->key;
	for (int k = 0; k < OB_SHAPE_KEYS && key[k].name; k++)
		for (int c = 0; c < 3; c++)
			if ((key[k].component == c || key[k].component == OB_SHAPE_SIDES) &&
			    !is_length(size[c] / key[k].share, e))
				return false;
	return true;
}

// A needle turns about its axis with too little inertia beside the others for all to be told apart.
static bool check_slenderness(const ob_passport *p, ob_error *e)
{
	const ob_shape shape = (ob_shape)p->shape;
	const double longest = 2 * ob_shape_longest(shape, p->size), least = ob_shape_thickness(shape, p->size);
	return within("size", " times as long as wide", 1, OB_SLENDERNESS_MOST, longest / least, e);
}

// Checks principal moments, unless all are 0: then they are the shape's. Shapes that look the same from all sides turn as such bodies do.
static bool check_inertia(const ob_passport *p, ob_error *e)
{
	const double x = p->inertia.x, y = p->inertia.y, z = p->inertia.z, more = 1 + 1e-9;
	const double most = fmax(x, fmax(y, z)), least = fmin(x, fmin(y, z)),
		     radius = ob_shape_radius((ob_shape)p->shape, p->size), unit = p->mass * radius * radius;
	if (x == 0 && y == 0 && z == 0)
		return true;
	if (!(x <= (y + z) * more && y <= (z + x) * more && z <= (x + y) * more))
		return ob_fail(e, "inertia: expected no moment above the sum of the others, got {%.10g, %.10g, %.10g}",
			       x, y, z);
	if (ob_shape_is(p->shape, OB_ROUND) && x != y)
		return ob_fail(e, "inertia: expected the first two alike for a %s, got %s and %s",
			       ob_shape_name(p->shape), ob_number_text(x).text, ob_number_text(y).text);
	if (ob_shape_is(p->shape, OB_ISOTROPIC) && x != z)
		return ob_fail(e, "inertia: expected all three alike for a %s", ob_shape_name(p->shape));
	return within("inertia", " times mass and radius squared", OB_INERTIA_LEAST, 1 / OB_INERTIA_LEAST, most / unit,
		      e) &&
	       within("inertia", " of the largest moment", 1 / (OB_SLENDERNESS_MOST * OB_SLENDERNESS_MOST), 1,
		      least / most, e);
}

bool ob_friction_check(double friction, ob_error *e)
{
	return within("friction", "", 0, OB_FRICTION_MOST, friction, e);
}

static bool check_surface(const ob_passport *p, ob_error *e)
{
	for (int i = 0; i < 4; i++)
		if (!within("colour", "", 0, 1, p->colour[i], e))
			return false;
	return ob_friction_check(p->friction, e) && within("restitution", "", 0, 1, p->restitution, e) &&
	       within("roughness", "", 0, 1, p->roughness, e) && within("metal", "", 0, 1, p->metal, e);
}

bool ob_surface_velocity_check(const ob_passport *p, ob_vec3 v, ob_error *e)
{
	if (!(p->flags & OB_OBJECT_PRESCRIBED))
		return ob_fail(e, "surface_velocity: expected a static or kinematic object");
	return within3("surface_velocity", " m/s", OB_SPEED_MOST, v, e);
}

bool ob_passport_check(const ob_passport *p, ob_error *e)
{
	if (!check_size(p, e) || !check_surface(p, e))
		return false;
	if (p->flags & OB_OBJECT_PRESCRIBED)
		return ob_surface_velocity_check(p, p->surface_velocity, e);
	return check_slenderness(p, e) && within("mass", " kg", OB_MASS_LEAST, OB_MASS_MOST, p->mass, e) &&
	       within3("force", " N", ob_force_most(p), p->force, e);
}

bool ob_state_check(const ob_passport *p, const ob_state *s, ob_error *e)
{
	const ob_quat q = s->pose.q;
	if (!within3("at", " m", OB_PLACE_MOST, s->pose.p, e) || !within3("velocity", " m/s", OB_SPEED_MOST, s->v, e) ||
	    !within3("spin", " rad/s", OB_SPIN_MOST, s->w, e))
		return false;
	if (!(fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-6))
		return ob_fail(e, "attitude: expected a unit quaternion");
	if (ob_shape_is(p->shape, OB_UNBOUNDED))
		return true;
	const double radius = ob_shape_radius((ob_shape)p->shape, p->size);
	return within("spin", " m/s at its surface", 0, OB_SPEED_MOST, ob_norm(s->w) * radius, e);
}

bool ob_path_check_turns(const ob_path *path, ob_error *e)
{
	const ob_path_point *first = path->point, *last = first + path->points - 1;
	ob_vec3 turn;
	if (path->loop && !ob_equal(first->p, last->p))
		return ob_fail(e, "loop: expected the last point where the first one is");
	for (uint32_t i = 1; path->turns && i < path->points; i++)
		if (!ob_path_turn(path->point[i - 1].q, path->point[i].q, &turn))
			return ob_fail(e, "points: expected less than half a turn from point %u to point %u", i, i + 1);
	if (path->turns && path->loop && (!ob_path_turn(last->q, first->q, &turn) || ob_norm(turn) > 1e-9))
		return ob_fail(e, "loop: expected the last point with the attitude of the first one");
	return true;
}

static bool check_speed(const ob_path *path, const ob_state *start, ob_error *e)
{
	const double swing = path->frequency > 0 ? ob_norm(path->a) / path->frequency : 0;
	ob_vec3 turn;
	for (uint32_t i = 0; i + 1 < path->points; i++) {
		const ob_path_point *from = &path->point[i], *to = from + 1;
		const double t = to->t - from->t;
		if (!within("path", " m/s", 0, OB_SPEED_MOST, ob_norm(ob_sub(to->p, from->p)) / t, e))
			return false;
		if (path->turns && ob_path_turn(from->q, to->q, &turn) &&
		    !within("path", " rad/s", 0, OB_SPIN_MOST, ob_norm(turn) / t, e))
			return false;
	}
	return path->points > 0 ||
	       within("path", " m/s", 0, OB_SPEED_MOST, ob_norm(ob_v3(ob_norm(start->v), swing, 0)), e);
}

static bool check_point(const ob_path *path, uint32_t i, ob_error *e)
{
	const ob_path_point *at = &path->point[i];
	const ob_quat q = at->q;
	const double before = i ? at[-1].t : 0, norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
	if (!(i ? at->t > before && at->t <= OB_TIME_MOST : at->t == 0))
		return ob_fail(e, "points: expected times that grow from 0 and end before %g s, got %s at point %u",
			       OB_TIME_MOST, ob_number_text(at->t).text, i + 1);
	if (path->turns && !(fabs(norm - 1) < 1e-6))
		return ob_fail(e, "points: expected a unit quaternion at point %u", i + 1);
	return within3("points", " m", OB_PLACE_MOST, at->p, e);
}

bool ob_path_check(const ob_path *path, double step_length, ob_error *e)
{
	uint32_t which;
	if (path->points < 2 || path->points > OB_PATH_POINTS_MAX)
		return ob_fail(e, "points: expected 2 to %d, got %u", OB_PATH_POINTS_MAX, path->points);
	for (uint32_t i = 0; i < path->points; i++)
		if (!check_point(path, i, e))
			return false;
	if (!ob_path_fits(path, step_length, &which))
		return ob_fail(e, "points: expected at least two steps of %g s from point %u to point %u", step_length,
			       which, which + 1);
	return ob_path_check_turns(path, e) && check_speed(path, NULL, e);
}

// The largest force in its course, beside the constant one.
static bool check_varying_force(const ob_force *f, const ob_passport *p, ob_error *e)
{
	const ob_vec3 rest = p->force;
	for (uint32_t i = 0; i <= f->points; i++) {
		const ob_vec3 now = i < f->points ? f->point[i].p : f->force;
		const ob_vec3 sum =
			ob_v3(fabs(now.x) + fabs(rest.x), fabs(now.y) + fabs(rest.y), fabs(now.z) + fabs(rest.z));
		if (!within3("varying_force", " N", ob_force_most(p), sum, e))
			return false;
	}
	return true;
}

bool ob_object_def_check(const ob_object_def *def, ob_error *e)
{
	const ob_passport *p = &def->passport;
	return ob_passport_check(p, e) && check_inertia(p, e) &&
	       (!def->path || check_speed(def->path, &def->state, e)) && ob_state_check(p, &def->state, e) &&
	       (!def->force || check_varying_force(def->force, p, e));
}

double ob_force_most(const ob_passport *p)
{
	return p->mass > 0 ? fmin(OB_FORCE_MOST, OB_ACCELERATION_MOST * p->mass) : OB_FORCE_MOST;
}

double ob_torque_most(const ob_passport *p)
{
	const double least = fmin(p->inertia.x, fmin(p->inertia.y, p->inertia.z));
	return least > 0 ? fmin(OB_FORCE_MOST, OB_ACCELERATION_MOST * least) : OB_FORCE_MOST;
}

bool ob_push_check(const ob_passport *p, ob_vec3 force, ob_vec3 twist, ob_error *e)
{
	return within3("force", "", ob_force_most(p), force, e) && within3("twist", "", ob_torque_most(p), twist, e);
}

// ---- whole objects, named

static bool name_fault(const ob_passport *p, const ob_error *why, ob_error *e)
{
	return ob_fail(e, "object \"%s\": %s", p->name, why->text);
}

static bool check_name(const ob_passport *p, ob_error *e)
{
	return memchr(p->name, 0, OB_NAME_MAX) ||
	       ob_fail(e, "object %u: its name is longer than %d characters", p->id, OB_NAME_MAX - 1);
}

bool ob_object_check(const ob_object_def *def, ob_error *e)
{
	ob_error why;
	return check_name(&def->passport, e) && (ob_object_def_check(def, &why) || name_fault(&def->passport, &why, e));
}

bool ob_object_check_saved(const ob_passport *p, ob_error *e)
{
	ob_error why;
	return check_name(p, e) && ((ob_passport_check(p, &why) && check_inertia(p, &why)) || name_fault(p, &why, e));
}

double ob_scene_thinnest(const ob_scene *s)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_passport *p = &s->object[i].passport;
		if (!(p->flags & OB_OBJECT_PRESCRIBED))
			least = fmin(least, ob_shape_thickness(p->shape, p->size));
	}
	return least;
}
