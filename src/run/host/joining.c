#include "host/joining.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/spelling.h"
#include "base/utf8.h"
#include "free/free.h"
#include "scene/object_limits.h"
#include "shape/shape.h"
#include "step/publish.h"
#include "step/sim.h"

// ---- requests

// Finds an object of the universe by its name, as it is now (ob_scene_options.find).
static bool find_joined(void *universe, const char *name, ob_joined *out)
{
	const ob_universe *u = universe;
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_passport p;
		ob_motion m;
		if (!ob_universe_get_passport(u, id, &p) || strncmp(p.name, name, OB_NAME_MAX) != 0 ||
		    !ob_universe_get_motion(u, id, &m))
			continue;
		*out = (ob_joined){ id, p.generation, !(p.flags & OB_OBJECT_PRESCRIBED),
				    ob_motion_at(&m, p.inertia, fmax(info.time, m.t0)).pose };
		return true;
	}
	return false;
}

bool ob_joint_request_find(const ob_universe *u, const char *name, ob_request *r, ob_error *e)
{
	ob_spelling near = ob_spelling_start(name);
	char best[OB_NAME_MAX];
	ob_joint_passport j;
	for (uint32_t i = 0; i < ob_universe_joints(u); i++) {
		if (!ob_universe_get_joint(u, i, &j) || j.flags & OB_JOINT_BROKEN)
			continue;
		if (strcmp(j.name, name) == 0) {
			r->joint = i;
			r->id = j.object[0], r->generation = j.generation[0];
			return true;
		}
		ob_spelling_offer(&near, j.name);
		near.best = near.best == j.name ? memcpy(best, j.name, sizeof best) : near.best;
	}
	return near.best ? ob_fail(e, "universe \"%s\" has no joint \"%s\": did you mean \"%s\"?", ob_universe_name(u),
				   name, near.best)
			 : ob_fail(e, "universe \"%s\" has no joint \"%s\"", ob_universe_name(u), name);
}

bool ob_create_as_scene(ob_universe *u, const char *text, size_t bytes, uint32_t origin,
			bool (*ask)(void *with, ob_request *r, ob_error *e), void *with, ob_error *e)
{
	const ob_scene_options options = { .joining = true, .find = find_joined, .with = u };
	ob_scene *scene = ob_scene_load_text("create", text, bytes, &options, e);
	bool fine = scene;
	for (uint32_t i = 0; fine && i < scene->objects; i++) {
		const ob_object_def *def = &scene->object[i];
		ob_request r = { .kind = OB_REQUEST_ADD, .origin = origin, .def = *def };
		if (ob_shape_is(def->passport.shape, OB_HULLED))
			r.corners = scene->hull_corners[def->passport.hull];
		if (def->script || def->born > 0 || def->dies < INFINITY || def->path || def->force)
			fine = ob_fail(e,
				       "create: expected neither script, born, dies, path nor varying_force: a scene's "
				       "objects have them");
		fine = fine && ask(with, &r, e);
	}
	for (uint32_t i = 0; fine && i < scene->joints; i++) {
		const ob_joint_passport *j = &scene->joint[i];
		ob_request r = {
			.kind = OB_REQUEST_JOIN, .id = j->object[0], .generation = j->generation[0], .bytes = sizeof *j
		};
		memcpy(r.values, j, sizeof *j);
		fine = ask(with, &r, e);
	}
	ob_scene_free(scene);
	return fine;
}

// ---- checks

static bool has_joint(const ob_universe *u, uint32_t object, uint32_t joint)
{
	const ob_step_data *data = ob_universe_step_data(u);
	return joint < ob_joints_end(data) && ob_joint_exists(&data->joint[joint]) &&
	       data->joint[joint].object[0] == object;
}

static bool is_there(const ob_universe *u, uint32_t id, uint32_t generation)
{
	const ob_passport *p = id < ob_universe_capacity(u) ? ob_passport_of(u, id) : NULL;
	return p && p->flags & OB_OBJECT_PRESENT && p->generation == generation;
}

static bool has_ends(const ob_universe *u, const ob_joint_passport *j)
{
	for (int side = 0; side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD && !is_there(u, j->object[side], j->generation[side]))
			return false;
	return true;
}

static bool check_motor(const ob_universe *u, const ob_request *r, ob_error *e)
{
	const ob_joint_passport *j = &ob_universe_step_data(u)->joint[r->joint];
	if (!ob_joint_holds(u, j))
		return ob_fail(e, "joint %u has broken, or ended with one of its objects", r->joint);
	if (j->axis.motor == OB_MOTOR_NONE)
		return ob_fail(e, "joint %u (%s) has no motor", r->joint, j->name);
	return fabs(r->motor) <= OB_JOINT_MOST ||
	       ob_fail(e, "the target of a motor must be a number of at most %g, is %g", OB_JOINT_MOST, r->motor);
}

// Checks a joint from outside: its objects exist, and forces move one of them.
static bool check_new(const ob_universe *u, const ob_joint_passport *j, ob_error *e)
{
	bool moved = false;
	if (ob_universe_settings(u)->monolith || ob_free_settings_of(u))
		return ob_fail(e, "only simulators in lockstep have joints");
	if (!ob_joint_makes_sense(j))
		return ob_fail(e, "the joint makes no sense");
	if (!has_ends(u, j))
		return ob_fail(e, "joint \"%s\": one of its objects has gone", j->name);
	for (int side = 0; side < 2; side++)
		moved |= j->object[side] != OB_JOINT_WORLD &&
			 !(ob_passport_of(u, j->object[side])->flags & OB_OBJECT_PRESCRIBED);
	return moved || ob_fail(e, "joint \"%s\": expected an object that is neither static nor kinematic", j->name);
}

// A joint from outside has a name that can be shown.
static void read_joint(ob_joint_passport *j, const void *from)
{
	memcpy(j, from, sizeof *j);
	j->name[OB_NAME_MAX - 1] = 0;
	ob_utf8_make_plain(j->name);
}

static bool joint_of(const ob_request *r, ob_joint_passport *j)
{
	if (r->bytes != sizeof *j)
		return false;
	read_joint(j, r->values);
	return j->object[0] == r->id && j->generation[0] == r->generation;
}

bool ob_joint_request_check(const ob_universe *u, const ob_request *r, ob_error *e)
{
	ob_joint_passport j;
	if (r->kind == OB_REQUEST_JOIN)
		return joint_of(r, &j) ? check_new(u, &j, e) : ob_fail(e, "the joint makes no sense");
	if (!has_joint(u, r->id, r->joint))
		return ob_fail(e, "object %u has no joint %u", r->id, r->joint);
	return r->kind == OB_REQUEST_UNJOIN || check_motor(u, r, e);
}

// ---- changes

// Contacts of both objects begin anew: a joint may let them overlap, or no longer.
static void renew_ends(ob_universe *u, const ob_joint_passport *j)
{
	for (int side = 0; side < 2; side++) {
		const uint32_t id = j->object[side];
		if (!is_there(u, id, j->generation[side]) || ob_passport_of(u, id)->flags & OB_OBJECT_PRESCRIBED)
			continue;
		const ob_state now = ob_state_now(u, id, ob_newest_motion(u, id), ob_step_count(u));
		ob_sim_place_anew(u, id, &now);
	}
}

static bool join(ob_universe *u, const ob_joint_passport *j, ob_error *e)
{
	if (!check_new(u, j, e))
		return false;
	if (ob_joint_add(u, j) == UINT32_MAX)
		return ob_fail(e, "joint \"%s\" was not added: the universe has no room for more: remove some",
			       j->name);
	renew_ends(u, j);
	return true;
}

static void unjoin(ob_universe *u, uint32_t joint)
{
	const ob_joint_passport j = ob_universe_step_data(u)->joint[joint];
	ob_joint_remove(u, joint);
	renew_ends(u, &j);
}

static void set_motor(ob_universe *u, uint32_t joint, double target)
{
	ob_joint_passport *j = &ob_universe_step_data(u)->joint[joint];
	if (j->axis.target != target)
		(void)ob_sim_wake_joined(u, j);
	j->axis.target = target;
}

void ob_joint_request_carry_out(ob_universe *u, const ob_request *r)
{
	ob_joint_passport j;
	ob_error e;
	if (r->kind == OB_REQUEST_MOTOR)
		set_motor(u, r->joint, r->motor);
	else if (r->kind == OB_REQUEST_UNJOIN)
		unjoin(u, r->joint);
	else if (joint_of(r, &j) && !join(u, &j, &e))
		ob_log_warn("%s", e.text);
}

// The joint between these objects with this name. Another one may have got the number of a joint that is asked for.
static uint32_t find_same(const ob_universe *u, const ob_joint_passport *j)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t end = ob_joints_end(data);
	uint32_t i = 0;
	while (i < end &&
	       (!ob_joint_exists(&data->joint[i]) || memcmp(data->joint[i].object, j->object, sizeof j->object) ||
		memcmp(data->joint[i].generation, j->generation, sizeof j->generation) ||
		strncmp(data->joint[i].name, j->name, OB_NAME_MAX)))
		i++;
	return i < end ? i : UINT32_MAX;
}

bool ob_joint_post_carry_out(ob_universe *u, const ob_script_post *post, ob_error *e)
{
	ob_joint_passport j;
	if ((post->kind != OB_REQUEST_JOIN && post->kind != OB_REQUEST_UNJOIN) || post->used != sizeof j)
		return ob_fail(e, "the joint makes no sense");
	if (post->kind == OB_REQUEST_JOIN) {
		read_joint(&j, post + 1);
		return !has_ends(u, &j) || join(u, &j, e);
	}
	memcpy(&j, post + 1, sizeof j);
	const uint32_t joint = find_same(u, &j);
	if (joint != UINT32_MAX)
		unjoin(u, joint);
	return true;
}
