#include "engine/mjcf.h"

#include <stdio.h>

#include "engine/world.h"
#include "shape/shape.h"

enum {
	CONTACTS_PER_BODY = 12, // average limit: memory for their rows grows with the square of the bodies
	CONTACTS_LEAST = 200,
	ROWS_PER_JOINT = 12, // at most
	DEPTH = 48, // of bodies in a file
};

// Ends an equality constraint, as hard as MuJoCo lets it be.
#define HARD " solimp=\".9999 .9999 .001\"/>\n"

bool ob_mjcf_moves(const ob_passport *o)
{
	return !(o->flags & OB_OBJECT_STATIC) && o->mass > 0;
}

// Motor that an equality constraint stands for.
static bool is_held(const ob_joint_axis *a)
{
	return a->motor == OB_MOTOR_RATE && isinf(a->most);
}

static void write_vector(FILE *f, const char *name, ob_vec3 v)
{
	fprintf(f, " %s=\"%.17g %.17g %.17g\"", name, v.x, v.y, v.z);
}

// Writes the time constant and the damping ratio of a contact's or a limit's spring, or -stiffness and -damping, the only
// form for a spring without damping.
static void write_spring(FILE *f, const char *name, double e, double h)
{
	double frequency = 1 / (2 * h), ratio = 1;
	if (e > 0)
		ratio = -log(fmin(e, 1)) / hypot(M_PI, log(fmin(e, 1)));
	if (e > 0)
		fprintf(f, " %s=\"%.17g %.17g\"", name, -frequency * frequency, -2 * ratio * frequency);
	else
		fprintf(f, " %s=\"%.17g 1\"", name, 1 / frequency);
}

// ---- joints of the tree

// Spring, damper and friction of a driven axis or tendon, and its limits. rest: the spring's attribute
static void write_acting(const ob_mjcf *m, FILE *f, const ob_joint_axis *a, const char *rest)
{
	static const double far = 1e10;
	fprintf(f, " stiffness=\"%.17g\" %s=\"%.17g\" damping=\"%.17g\" frictionloss=\"%.17g\"", a->stiffness, rest,
		a->rest, a->damping, a->friction);
	if (isinf(a->low) && isinf(a->high))
		return;
	fprintf(f, " limited=\"true\" range=\"%.17g %.17g\"", fmax(a->low, -far), fmin(a->high, far));
	write_spring(f, "solreflimit", a->restitution, m->step);
}

// second: 1 of a universal's second axis
static void write_axis(const ob_mjcf *m, FILE *f, uint32_t joint, int second, const char *type, ob_vec3 at,
		       ob_vec3 axis)
{
	const ob_joint_passport *j = &m->world->joint[joint];
	ob_joint_axis a = second ? j->second : j->axis;
	fprintf(f, "<joint name=\"%u%s\" type=\"%s\"", joint, second ? ".2" : "", type);
	write_vector(f, "pos", at);
	write_vector(f, "axis", axis);
	if (j->kind == OB_JOINT_BALL)
		a.low = isinf(a.high) ? a.low : 0;
	if (j->flags & OB_JOINT_DRIVEN) {
		fprintf(f, " armature=\"%.17g\"", a.armature);
		write_acting(m, f, &a, "springref");
	}
	fputs("/>", f);
}

// A value is that of the first object relative to the second, so axes turn round where the first is the parent. Axes of a
// universal are in the child's frame, as the world begins: that of the parent comes first.
static void write_joint(const ob_mjcf *m, FILE *f, uint32_t id)
{
	static const char *const type[OB_JOINT_KINDS] = { [OB_JOINT_BALL] = "ball",
							  [OB_JOINT_HINGE] = "hinge",
							  [OB_JOINT_SLIDER] = "slide",
							  [OB_JOINT_UNIVERSAL] = "hinge" };
	if (m->tree[id] == OB_JOINT_WORLD) {
		fputs("<freejoint/>", f);
		return;
	}
	const ob_joint_passport *j = &m->world->joint[m->tree[id]];
	const bool cross = j->kind == OB_JOINT_UNIVERSAL;
	const int child = j->object[0] != id;
	const ob_mat3 axes = ob_quat_matrix(j->frame[child].q);
	for (int i = 0; type[j->kind] && i < 1 + cross; i++) {
		const int second = cross && i == child; // the first object has the first axis
		write_axis(m, f, m->tree[id], second, type[j->kind], j->frame[child].p,
			   ob_scale(ob_column(&axes, cross ? second : 2), child ? -1 : 1));
	}
}

// ---- bodies

static void write_geom(FILE *f, const ob_passport *o, double h)
{
	static const char *const type[OB_SHAPE_KINDS] = {
		[OB_SHAPE_SPHERE] = "sphere",   [OB_SHAPE_BOX] = "box",           [OB_SHAPE_PLANE] = "plane",
		[OB_SHAPE_CAPSULE] = "capsule", [OB_SHAPE_CYLINDER] = "cylinder",
	};
	if (!type[o->shape])
		return;
	fprintf(f, "<geom name=\"%u\" type=\"%s\" friction=\"%.17g 0 0\"", o->id, type[o->shape], o->friction);
	write_vector(f, "size", o->shape == OB_SHAPE_PLANE ? ob_v3(0, 0, 1) : o->size);
	write_spring(f, "solref", o->restitution, h);
	fputs("/>", f);
}

// Sites at the ends of distances.
static void write_sites(const ob_mjcf *m, FILE *f, uint32_t id)
{
	for (uint32_t i = 0; i < m->world->joints; i++) {
		const ob_joint_passport *j = &m->world->joint[i];
		for (int side = 0; side < 2; side++) {
			if (j->kind != OB_JOINT_DISTANCE || j->object[side] != id)
				continue;
			fprintf(f, "<site name=\"%u.%d\"", i, side);
			write_vector(f, "pos", j->frame[side].p);
			fputs("/>", f);
		}
	}
}

static bool write_bodies(ob_mjcf *m, FILE *f, uint32_t parent, uint32_t depth);

static bool write_body(ob_mjcf *m, FILE *f, uint32_t id, const ob_pose *parent, uint32_t depth)
{
	const ob_passport *o = &m->world->passport[id];
	const ob_pose *at = &m->world->state[id].pose;
	const ob_mat3 r = ob_quat_matrix(parent->q);
	const ob_quat q = ob_quat_mul(ob_quat_conjugate(parent->q), at->q);
	fprintf(f, "<body name=\"%u\" quat=\"%.17g %.17g %.17g %.17g\"", id, q.w, q.x, q.y, q.z);
	write_vector(f, "pos", ob_rotate_back(&r, ob_sub(at->p, parent->p)));
	fputs(">", f);
	if (ob_mjcf_moves(o)) {
		write_joint(m, f, id);
		fprintf(f, "<inertial pos=\"0 0 0\" mass=\"%.17g\"", o->mass);
		write_vector(f, "diaginertia", o->inertia);
		fputs("/>", f);
	}
	write_geom(f, o, m->step);
	write_sites(m, f, id);
	const bool all = write_bodies(m, f, id, depth + 1);
	fputs("</body>\n", f);
	return all;
}

static FILE *begin_file(ob_mjcf *m)
{
	if (m->files == OB_MJCF_FILES)
		return NULL;
	struct ob_mjcf_file *file = &m->file[m->files++];
	return open_memstream(&file->text, &file->length);
}

// Goes on in a file of its own, if bodies are too deep.
static bool write_deep(ob_mjcf *m, FILE *f, uint32_t id, const ob_pose *parent, uint32_t depth)
{
	char name[16];
	if (depth < DEPTH)
		return write_body(m, f, id, parent, depth);
	ob_mjcf_name(m->files, name);
	fprintf(f, "<include file=\"%s\"/>", name);
	FILE *deeper = begin_file(m);
	if (!deeper)
		return false;
	fputs("<mujoco>", deeper);
	const bool all = write_body(m, deeper, id, parent, 0);
	fputs("</mujoco>\n", deeper);
	return !fclose(deeper) && all;
}

// parent: OB_JOINT_WORLD: all that no body holds
static bool write_bodies(ob_mjcf *m, FILE *f, uint32_t parent, uint32_t depth)
{
	const ob_world *w = m->world;
	const ob_pose at = parent == OB_JOINT_WORLD ? (ob_pose){ .q = ob_quat_identity() } : w->state[parent].pose;
	bool all = true;
	for (uint32_t id = 0; id < w->objects && all; id++) {
		const uint32_t joint = m->tree[id];
		const uint32_t by = joint == OB_JOINT_WORLD ? joint : ob_joint_other(&w->joint[joint], id);
		if (by == parent)
			all = write_deep(m, f, id, &at, depth);
	}
	return all;
}

// ---- contacts

// First of the joints that let these two pass through each other; their number: none.
static uint32_t parted_by(const ob_world *w, uint32_t a, uint32_t b)
{
	uint32_t i = 0;
	for (; i < w->joints; i++) {
		const ob_joint_passport *j = &w->joint[i];
		if (!(j->flags & OB_JOINT_COLLIDES) &&
		    ((j->object[0] == a && j->object[1] == b) || (j->object[0] == b && j->object[1] == a)))
			break;
	}
	return i;
}

// Writes the pairs for which MuJoCo would combine another friction or restitution; returns false if they are too many.
// Its automatic contacts between the two bodies are excluded, or they would touch twice.
static bool write_pairs(const ob_mjcf *m, FILE *f)
{
	const ob_world *w = m->world;
	uint32_t declared = 0;
	for (uint32_t i = 0; i < w->objects; i++) {
		for (uint32_t j = 0; j < i; j++) {
			const ob_passport *a = &w->passport[i], *b = &w->passport[j];
			if ((!ob_mjcf_moves(a) && !ob_mjcf_moves(b)) || !a->shape || !b->shape ||
			    (a->friction == b->friction && a->restitution == b->restitution) ||
			    parted_by(w, i, j) < w->joints)
				continue;
			if (++declared > OB_MJCF_PAIRS)
				return false;
			double mu = sqrt(a->friction * b->friction);
			fprintf(f, "<pair geom1=\"%u\" geom2=\"%u\" condim=\"3\" friction=\"%.17g %.17g 0 0 0\"", j, i,
				mu, mu);
			write_spring(f, "solref", fmax(a->restitution, b->restitution), m->step);
			fprintf(f, "/><exclude body1=\"%u\" body2=\"%u\"/>\n", j, i);
		}
	}
	return true;
}

static void write_parted(const ob_mjcf *m, FILE *f)
{
	for (uint32_t i = 0; i < m->world->joints; i++) {
		const ob_joint_passport *j = &m->world->joint[i];
		if (j->object[1] != OB_JOINT_WORLD && parted_by(m->world, j->object[0], j->object[1]) == i)
			fprintf(f, "<exclude body1=\"%u\" body2=\"%u\"/>\n", j->object[0], j->object[1]);
	}
}

// ---- constraints, tendons, motors

static bool is_in_tree(const ob_mjcf *m, uint32_t joint)
{
	const uint32_t *object = m->world->joint[joint].object;
	for (int side = 0; side < 2; side++)
		if (object[side] != OB_JOINT_WORLD && m->tree[object[side]] == joint)
			return true;
	return false;
}

static void write_hard(const ob_mjcf *m, FILE *f)
{
	write_spring(f, "solref", 0, m->step);
	fputs(HARD, f);
}

static void write_between(FILE *f, const char *kind, const ob_joint_passport *j)
{
	fprintf(f, "<%s body1=\"%u\"", kind, j->object[0]);
	if (j->object[1] != OB_JOINT_WORLD)
		fprintf(f, " body2=\"%u\"", j->object[1]);
}

static void write_loop(const ob_mjcf *m, FILE *f, const ob_joint_passport *j)
{
	const ob_mat3 axes = ob_quat_matrix(j->frame[0].q);
	const int ends = j->kind == OB_JOINT_HINGE ? 2 : j->kind == OB_JOINT_BALL;
	for (int i = 0; i < ends; i++) {
		write_between(f, "connect", j);
		write_vector(f, "anchor", ob_madd(j->frame[0].p, i, ob_column(&axes, 2)));
		write_hard(m, f);
	}
	if (j->kind == OB_JOINT_FIXED) {
		write_between(f, "weld", j);
		write_hard(m, f);
	}
}

static ob_vec3 place_of(const ob_world *w, const ob_joint_passport *j, int side)
{
	if (j->object[side] == OB_JOINT_WORLD)
		return j->frame[side].p;
	const ob_pose *at = &w->state[j->object[side]].pose;
	const ob_mat3 r = ob_quat_matrix(at->q);
	return ob_add(at->p, ob_rotate(&r, j->frame[side].p));
}

static const char *element_of(const ob_joint_passport *j)
{
	return j->kind == OB_JOINT_DISTANCE ? "tendon" : "joint";
}

// The constraint's acceleration is -damping rate - stiffness (value - place). Its place is so far away, and its stiffness so low,
// that their product is the damping times the motor's rate.
static void write_held(const ob_mjcf *m, FILE *f, uint32_t joint, int second)
{
	static const double far = 1e9; // s
	const ob_joint_passport *j = &m->world->joint[joint];
	const double damping = 1 / m->step, rate = second ? j->second.target : j->axis.target;
	const char *kind = element_of(j);
	fprintf(f, "<%s %s1=\"%u%s\" polycoef=\"%.17g 1 0 0 0\" solref=\"%.17g %.17g\"" HARD, kind, kind, joint,
		second ? ".2" : "", rate * far, -damping / far, -damping);
}

static void write_equalities(const ob_mjcf *m, FILE *f)
{
	for (uint32_t i = 0; i < m->world->joints; i++) {
		const ob_joint_passport *j = &m->world->joint[i];
		const bool driven = j->flags & OB_JOINT_DRIVEN;
		if (j->kind != OB_JOINT_DISTANCE && !is_in_tree(m, i))
			write_loop(m, f, j);
		if (j->kind == OB_JOINT_DISTANCE && !driven) {
			const ob_vec3 apart = ob_sub(place_of(m->world, j, 0), place_of(m->world, j, 1));
			fprintf(f, "<tendon tendon1=\"%u\" polycoef=\"%.17g 1 0 0 0\"", i, j->length - ob_norm(apart));
			write_hard(m, f);
		}
		for (int second = 0; second < 2 && driven; second++) {
			if (is_held(second ? &j->second : &j->axis))
				write_held(m, f, i, second);
		}
	}
}

static void write_tendons(const ob_mjcf *m, FILE *f)
{
	for (uint32_t i = 0; i < m->world->joints; i++) {
		const ob_joint_passport *j = &m->world->joint[i];
		if (j->kind != OB_JOINT_DISTANCE)
			continue;
		fprintf(f, "<spatial name=\"%u\"", i);
		if (j->flags & OB_JOINT_DRIVEN)
			write_acting(m, f, &j->axis, "springlength");
		fprintf(f, "><site site=\"%u.0\"/><site site=\"%u.1\"/></spatial>\n", i, i);
	}
}

// The gain of one that holds a rate is set when the model is known.
static void write_motors(const ob_mjcf *m, FILE *f)
{
	for (uint32_t i = 0; i < m->world->joints; i++) {
		const ob_joint_passport *j = &m->world->joint[i];
		for (int second = 0; second < 2 && j->flags & OB_JOINT_DRIVEN; second++) {
			const ob_joint_axis *a = second ? &j->second : &j->axis;
			if (a->motor == OB_MOTOR_NONE || is_held(a))
				continue;
			const char *suffix = second ? ".2" : "";
			fprintf(f, "<general name=\"%u%s\" %s=\"%u%s\" gainprm=\"%.17g\" biastype=\"affine\" ", i,
				suffix, element_of(j), i, suffix, a->motor_stiffness);
			fprintf(f, "biasprm=\"0 %.17g %.17g\"", -a->motor_stiffness, -a->motor_damping);
			if (isfinite(a->most))
				fprintf(f, " forcelimited=\"true\" forcerange=\"%.17g %.17g\"", -a->most, a->most);
			fputs("/>\n", f);
		}
	}
}

void ob_mjcf_name(uint32_t file, char name[16])
{
	snprintf(name, 16, "%u.xml", file);
}

static bool write_world(ob_mjcf *m, FILE *f)
{
	const ob_world *w = m->world;
	const uint32_t contacts = CONTACTS_LEAST + CONTACTS_PER_BODY * w->objects;
	fprintf(f,
		"<mujoco><compiler angle=\"radian\"/>\n"
		"<option timestep=\"%.17g\" integrator=\"%s\" cone=\"elliptic\" impratio=\"10\" solver=\"Newton\" "
		"iterations=\"%u\" tolerance=\"1e-12\"",
		m->step, m->integrator, m->iterations);
	write_vector(f, "gravity", w->gravity);
	fprintf(f, "><flag filterparent=\"disable\"/></option>\n<size nconmax=\"%u\" njmax=\"%u\"/>\n<worldbody>\n",
		contacts, 3 * contacts + ROWS_PER_JOINT * w->joints);
	write_sites(m, f, OB_JOINT_WORLD);
	bool all = write_bodies(m, f, OB_JOINT_WORLD, 0);
	fputs("</worldbody>\n<contact>\n", f);
	all &= write_pairs(m, f);
	write_parted(m, f);
	fputs("</contact>\n<equality>\n", f);
	write_equalities(m, f);
	fputs("</equality>\n<tendon>\n", f);
	write_tendons(m, f);
	fputs("</tendon>\n<actuator>\n", f);
	write_motors(m, f);
	fputs("</actuator></mujoco>\n", f);
	return all;
}

bool ob_mjcf_write(ob_mjcf *m)
{
	FILE *f = begin_file(m);
	const bool all = f && write_world(m, f);
	return f && !fclose(f) && all;
}
