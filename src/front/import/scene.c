// Writes a model as a scene: objects, joints, and the list of what has no counterpart.
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "hull/hull.h"
#include "import/load.h"
#include "import/look.h"
#include "import/import.h"
#include "import/solid.h"
#include "motion/depth.h"
#include "shape/shape.h"

enum { NAME = OB_NAME_MAX, GROUPS_NONE = -1, WORLD = -1 };
static const double link_share = 1e-6; // in masses of a body: a link between two joints of one body

// Object of the scene.
typedef struct part {
	char name[NAME];
	int body, geom; // geom: one that stands still; -1: a body that moves
	ob_imported_solid solid;
	int group; // number for its contype and conaffinity
	int contype, conaffinity;
} part;

// Pair of objects that must not touch.
typedef struct apart {
	int a, b;
} apart;

typedef struct writer {
	const ob_drawn *d;
	const mjModel *m;
	FILE *out, *omitted;
	const char *folder; // for looks; NULL: none are written
	part *part;
	int parts, parts_max;
	int *part_of; // [bodies]: part that moves with the body; WORLD: it stands still
	int links; // written so far
	bool *sensed; // [joints]: it has a name, as an encoder reads it
	apart *joined; // pairs that a joint holds, or that are apart
	int joined_count, joined_max;
} writer;

static void leave_out(writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void leave_out(writer *w, const char *format, ...)
{
	char line[400];
	va_list args;
	va_start(args, format);
	vsnprintf(line, sizeof line, format, args);
	va_end(args);
	ob_utf8_make_plain(line);
	fprintf(w->omitted, "%s\n", line);
}

// Name of a thing of the model, or its kind and number.
static const char *name_of(const writer *w, int type, const char *kind, int id)
{
	static char text[4][NAME + 40];
	static int next;
	const char *name = mj_id2name(w->m, type, id);
	char *to = text[next++ % 4];
	if (name && *name)
		snprintf(to, sizeof text[0], "%s \"%.*s\"", kind, NAME - 1, name);
	else
		snprintf(to, sizeof text[0], "%s %d", kind, id);
	return to;
}

// ---- objects

static bool is_named(const writer *w, const char *name)
{
	for (int i = 0; i < w->parts; i++)
		if (strcmp(w->part[i].name, name) == 0)
			return true;
	return false;
}

// Chooses a name that a scene may have, and that no other object has.
static void choose_name(const writer *w, const char *wanted, int number, char out[NAME])
{
	char plain[NAME - 12];
	size_t n = 0;
	for (const char *c = wanted; *c && n + 1 < sizeof plain; c++)
		plain[n++] = (unsigned char)*c < ' ' || strchr("#\"\\", *c) || (unsigned char)*c > '~' ? '_' : *c;
	plain[n] = 0;
	snprintf(out, NAME, "%s", plain);
	for (int i = number; is_named(w, out) || !n; i++) {
		snprintf(out, NAME, "%s %d", n ? plain : "body", i);
		if (!is_named(w, out))
			return;
	}
}

static void *grow(void *list, int count, int *max, size_t each)
{
	if (count < *max)
		return list;
	*max = 2 * *max + 16;
	void *more = realloc(list, (size_t)*max * each);
	if (!more)
		exit(EXIT_FAILURE); // the child's; its parent explains it
	return more;
}

static part *add_part(writer *w, int body, int geom, const char *name)
{
	w->part = grow(w->part, w->parts, &w->parts_max, sizeof *w->part);
	part *p = &w->part[w->parts];
	memset(p, 0, sizeof *p);
	choose_name(w, name ? name : "", body, p->name);
	p->body = body, p->geom = geom, p->group = GROUPS_NONE;
	w->parts++;
	return p;
}

static void note_contacts(const writer *w, part *p, int geom)
{
	p->contype |= w->m->geom_contype[geom];
	p->conaffinity |= w->m->geom_conaffinity[geom];
}

// True if a scene may have the shape (object_limits.h).
static bool in_range(const ob_imported_solid *s)
{
	const double least = 1e-6, most = 1e6, farthest = 1e7, size[3] = { s->size.x, s->size.y, s->size.z };
	const ob_shape_key *key = ob_shape_kind_of(s->shape)->key;
	bool fits = fabs(s->pose.p.x) <= farthest && fabs(s->pose.p.y) <= farthest && fabs(s->pose.p.z) <= farthest;
	for (int k = 0; k < OB_SHAPE_KEYS && key[k].name; k++)
		for (int c = 0; c < 3; c++)
			if (key[k].component == c || key[k].component == OB_SHAPE_SIDES)
				fits &= size[c] / key[k].share >= least && size[c] / key[k].share <= most;
	return fits;
}

static void add_standing(writer *w, int body)
{
	const mjModel *m = w->m;
	for (int geom = m->body_geomadr[body]; geom < m->body_geomadr[body] + m->body_geomnum[body]; geom++) {
		const char *own = mj_id2name(m, mjOBJ_GEOM, geom), *of = mj_id2name(m, mjOBJ_BODY, body);
		if (!ob_geom_collides(m, geom))
			continue;
		part *p = add_part(w, body, geom, own && *own ? own : body ? of : "world");
		note_contacts(w, p, geom);
		ob_solid_of_geom(w->d, geom, &p->solid);
		const char *wrong = p->solid.shape == OB_SHAPE_NONE ? "it is a height field, or a mesh without extent"
				    : !in_range(&p->solid)          ? "its numbers are out of range"
								    : NULL;
		if (wrong) {
			leave_out(w, "%s is left out: %s", p->name, wrong);
			w->parts--;
			continue;
		}
		if (p->solid.inside > 0)
			leave_out(w, "%s collides as a hull of %u corners, up to %.2g m inside it", p->name,
				  p->solid.hull->corners, p->solid.inside);
	}
}

// A body without a shape of its own: a box of its moments, which nothing touches.
static void give_box(const writer *w, part *p)
{
	const double m = w->m->body_mass[p->body];
	const ob_vec3 i = p->solid.inertia;
	const double half[3] = { i.y + i.z - i.x, i.z + i.x - i.y, i.x + i.y - i.z };
	double side[3], most = 0;
	for (int k = 0; k < 3; k++) {
		side[k] = sqrt(fmax(0, 1.5 * half[k] / m));
		most = fmax(most, side[k]);
	}
	for (int k = 0; k < 3; k++)
		side[k] = fmax(side[k], .05 * most);
	p->solid.shape = OB_SHAPE_BOX;
	p->solid.size = ob_v3(side[0], side[1], side[2]);
	p->contype = p->conaffinity = 0;
}

// True if a scene may have the moments with this shape (object_limits.h).
static bool inertia_fits(const writer *w, const part *p)
{
	const ob_imported_solid *s = &p->solid;
	const double least = 1e-4, most = fmax(s->inertia.x, fmax(s->inertia.y, s->inertia.z));
	if (s->shape == OB_SHAPE_NONE)
		return true;
	const double r = s->hull ? s->hull->radius : ob_shape_radius(s->shape, s->size),
		     share = most / (w->m->body_mass[p->body] * r * r);
	return share >= least && share <= 1 / least;
}

static void add_moving(writer *w, int body)
{
	const mjModel *m = w->m;
	part *p = add_part(w, body, -1, mj_id2name(m, mjOBJ_BODY, body));
	int looks = 0;
	w->part_of[body] = w->parts - 1;
	for (int geom = 0; geom < m->ngeom; geom++)
		if (ob_drawn_holder(m, m->geom_bodyid[geom]) == body) {
			looks += !ob_geom_collides(m, geom);
			note_contacts(w, p, geom);
		}
	ob_solid_of_body(w->d, body, &p->solid);
	if (looks && !w->folder)
		leave_out(w, "%s: %d geoms that are looks alone are left out: --out DIR writes them", p->name, looks);
	if (!inertia_fits(w, p)) {
		leave_out(w, "%s collides with nothing: its moments are too large or too small for its shape", p->name);
		p->solid.shape = OB_SHAPE_NONE;
		p->solid.hull = NULL, p->solid.pieces = 0;
	} else if (p->solid.shape == OB_SHAPE_NONE && p->solid.geoms)
		leave_out(w, "%s collides with nothing: its centre of mass is not well inside the hull of its %u geoms",
			  p->name, p->solid.geoms);
	else if (p->solid.geoms > 1 && p->solid.pieces == 1)
		leave_out(w, "%s collides as the hull of its %u geoms, with %u corners, up to %.2g m inside it",
			  p->name, p->solid.geoms, p->solid.hull->corners, p->solid.inside);
	else if (p->solid.inside > 0)
		leave_out(w, "%s collides as %u parts for its geoms, up to %.2g m inside them", p->name,
			  p->solid.pieces, p->solid.inside);
	if (p->solid.shape == OB_SHAPE_NONE)
		give_box(w, p);
}

// True if the body stands still: nothing on its way to the world moves.
static bool stands(const writer *w, int body)
{
	return w->m->body_weldid[body] == 0 && !(w->d->floats && body != 0);
}

static void collect(writer *w)
{
	const mjModel *m = w->m;
	for (int body = 0; body < m->nbody; body++) {
		w->part_of[body] = WORLD;
		if (stands(w, body)) {
			add_standing(w, body);
		} else if (ob_drawn_has_mass(m, body)) {
			add_moving(w, body);
		} else {
			w->part_of[body] = w->part_of[m->body_parentid[body]];
			if (m->body_geomnum[body] && !ob_drawn_has_mass(m, ob_drawn_holder(m, body)))
				leave_out(w, "%s has no mass: its geoms are left out",
					  name_of(w, mjOBJ_BODY, "body", body));
		}
	}
	// A root without mass is what is fixed to it first.
	for (int body = m->nbody - 1; body > 0; body--) {
		const int parent = m->body_parentid[body];
		if (w->part_of[body] != WORLD && w->part_of[parent] == WORLD && !stands(w, parent) &&
		    !m->body_jntnum[body])
			w->part_of[parent] = w->part_of[body];
	}
}

// ---- groups

static bool touch(const part *a, const part *b)
{
	return (a->contype & b->conaffinity) || (b->contype & a->conaffinity);
}

static bool same_group(const part *a, const part *b)
{
	return a->contype == b->contype && a->conaffinity == b->conaffinity;
}

// Numbers the groups in the order of the objects; those of contype 1 and conaffinity 1 alone have none. Returns their
// number.
static int number_groups(writer *w)
{
	int groups = 0;
	bool plain = true;
	for (int i = 0; i < w->parts && w->m->opt.disableflags & mjDSBL_CONTACT; i++)
		w->part[i].contype = w->part[i].conaffinity = 0;
	for (int i = 0; i < w->parts; i++)
		plain &= w->part[i].contype == 1 && w->part[i].conaffinity == 1;
	for (int i = 0; i < w->parts && !plain; i++) {
		part *p = &w->part[i];
		for (int k = 0; k < i && p->group < 0; k++)
			if (same_group(p, &w->part[k]))
				p->group = w->part[k].group;
		if (p->group < 0)
			p->group = groups++;
	}
	if (groups <= OB_GROUPS)
		return groups;
	leave_out(w, "contype and conaffinity: %d combinations, and a scene has %d groups: all collide", groups,
		  OB_GROUPS);
	for (int i = 0; i < w->parts; i++)
		w->part[i].group = GROUPS_NONE;
	return 0;
}

// ---- Lua

static void write_vec(const writer *w, const char *key, ob_vec3 v)
{
	fprintf(w->out, "%s = { %.17g, %.17g, %.17g }", key, v.x, v.y, v.z);
}

static void write_pose(const writer *w, const ob_pose *p)
{
	write_vec(w, ", at", p->p);
	if (fabs(p->q.w) < 1)
		fprintf(w->out, ", q = { %.17g, %.17g, %.17g, %.17g }", p->q.w, p->q.x, p->q.y, p->q.z);
}

static void write_colour(const writer *w, const part *p)
{
	const mjModel *m = w->m;
	const int first = p->geom >= 0 ? p->geom : m->body_geomadr[p->body];
	if (p->geom < 0 && !m->body_geomnum[p->body])
		return;
	const int material = m->geom_matid[first];
	const float *c = material >= 0 ? m->mat_rgba + 4 * material : m->geom_rgba + 4 * first;
	double rgb[3];
	for (int k = 0; k < 3; k++)
		rgb[k] = fmin(1, fmax(0, c[k]));
	fprintf(w->out, ", colour = { %.3g, %.3g, %.3g }", rgb[0], rgb[1], rgb[2]);
}

static double friction_of(const writer *w, const part *p)
{
	const mjModel *m = w->m;
	const int first = p->geom >= 0 ? p->geom : m->body_geomadr[p->body];
	const int end = p->geom >= 0 ? first + 1 : first + m->body_geomnum[p->body];
	for (int geom = first; geom < end; geom++)
		if (ob_geom_collides(m, geom))
			return fmin(1000, fmax(0, m->geom_friction[3 * geom]));
	return 1;
}

static void write_group(const writer *w, const part *p, int groups)
{
	if (p->group < 0 && (p->contype || p->conaffinity))
		return;
	if (p->group >= 0)
		fprintf(w->out, ", group = %d", p->group);
	fputs(", hits = {", w->out);
	const char *before = " ";
	for (int g = 0; g < groups; g++)
		for (int i = 0; i < w->parts; i++)
			if (w->part[i].group == g) {
				if (touch(p, &w->part[i])) {
					fprintf(w->out, "%s%d", before, g);
					before = ", ";
				}
				break;
			}
	fputs(" }", w->out);
}

static void write_piece(const writer *w, const ob_imported_piece *p)
{
	if (p->half.x > 0) {
		write_vec(w, "size", ob_scale(p->half, 2));
		write_pose(w, &p->pose);
		return;
	}
	if (p->round) {
		fprintf(w->out, "shape = \"%s\", radius = %.17g", ob_shape_name(p->round), p->size.x);
		if (p->size.y > 0)
			fprintf(w->out, ", length = %.17g", 2 * p->size.y);
		write_pose(w, &p->pose);
		return;
	}
	fputs("points = {", w->out);
	for (uint32_t k = 0; k < p->points; k++)
		fprintf(w->out, "%s{ %.17g, %.17g, %.17g }", k ? ", " : " ", p->point[k].x, p->point[k].y,
			p->point[k].z);
	fputs(" }", w->out);
}

// Writes the parts of a compound, or the points of a hull.
static void write_pieces(const writer *w, const ob_imported_solid *s)
{
	const bool compound = ob_solid_is_compound(s);
	fputs(compound ? "parts = { { " : "", w->out);
	for (uint32_t i = 0; i < s->pieces; i++) {
		fputs(i ? " }, { " : "", w->out);
		write_piece(w, &s->piece[i]);
	}
	fputs(compound ? " } }" : "", w->out);
}

static void write_shape(const writer *w, const ob_imported_solid *s)
{
	const ob_shape_key *key = ob_shape_kind_of(s->shape)->key;
	const double size[3] = { s->size.x, s->size.y, s->size.z };
	if (s->pieces) {
		write_pieces(w, s);
		return;
	}
	for (int k = 0; k < OB_SHAPE_KEYS && key[k].name; k++)
		if (key[k].component == OB_SHAPE_SIDES)
			write_vec(w, key[k].name, ob_scale(s->size, 1 / key[k].share));
		else
			fprintf(w->out, "%s%s = %.17g", k ? ", " : "", key[k].name,
				size[key[k].component] / key[k].share);
}

static void write_plane(const writer *w, const part *p)
{
	const ob_mat3 r = ob_quat_matrix(p->solid.pose.q);
	write_vec(w, "normal", ob_column(&r, 2));
	write_vec(w, ", at", p->solid.pose.p);
}

// Writes the look of an object into a file of its own, unless its shape is its look.
static void write_look(writer *w, const part *p, int number)
{
	const mjModel *m = w->m;
	const int first = p->geom >= 0 ? p->geom : m->body_geomadr[p->body];
	const int end = p->geom >= 0 ? first + 1 : first + m->body_geomnum[p->body];
	char file[32], path[4096];
	ob_error e;
	if (!w->folder || p->solid.shape == OB_SHAPE_PLANE || end == first ||
	    (end == first + 1 && p->solid.shape != OB_SHAPE_HULL))
		return;
	snprintf(file, sizeof file, "look_%d.glb", number);
	snprintf(path, sizeof path, "%s/%s", w->folder, file);
	if (ob_look_write(w->d, first, end, &p->solid.pose, path, &e))
		fprintf(w->out, ", mesh = \"%s\"", file);
	else
		leave_out(w, "%s: its look is left out: %s", p->name, e.text);
}

static void write_part(writer *w, const part *p, int groups)
{
	const ob_imported_solid *s = &p->solid;
	fprintf(w->out, "%s { name = \"%s\", ", ob_solid_is_compound(s) ? "compound" : ob_shape_name(s->shape),
		p->name);
	if (s->shape == OB_SHAPE_PLANE) {
		write_plane(w, p);
	} else {
		write_shape(w, s);
		write_pose(w, &s->pose);
		if (p->geom >= 0)
			fputs(", static = true", w->out);
	}
	if (p->geom < 0) {
		fprintf(w->out, ", mass = %.17g", w->m->body_mass[p->body]);
		write_vec(w, ", inertia", s->inertia);
	}
	fprintf(w->out, ", friction = %.9g", friction_of(w, p));
	write_group(w, p, groups);
	if (!w->folder || p->solid.shape != OB_SHAPE_HULL)
		write_colour(w, p);
	write_look(w, p, (int)(p - w->part));
	fputs(" }\n", w->out);
}

// ---- joints

static bool are_joined(const writer *w, int a, int b)
{
	for (int i = 0; i < w->joined_count; i++)
		if ((w->joined[i].a == a && w->joined[i].b == b) || (w->joined[i].a == b && w->joined[i].b == a))
			return true;
	return false;
}

static void join(writer *w, int a, int b)
{
	w->joined = grow(w->joined, w->joined_count, &w->joined_max, sizeof *w->joined);
	w->joined[w->joined_count++] = (apart){ a, b };
}

// Writes that two objects pass through each other, once.
static void keep_apart(writer *w, int a, int b)
{
	if (a == b || are_joined(w, a, b))
		return;
	join(w, a, b);
	fprintf(w->out, "apart { \"%s\", \"%s\" }\n", w->part[a].name, w->part[b].name);
}

// Actuator that pulls a joint to a place by itself, as servos do; -1: none.
static int servo_of(const writer *w, int joint)
{
	const mjModel *m = w->m;
	for (int a = 0; a < m->nu; a++)
		if (m->actuator_trntype[a] == mjTRN_JOINT && m->actuator_trnid[2 * a] == joint &&
		    m->actuator_biastype[a] == mjBIAS_AFFINE && m->actuator_dyntype[a] == mjDYN_NONE &&
		    m->actuator_biasprm[mjNBIAS * a + 1] < 0)
			return a;
	return -1;
}

static bool has_one_axis(const writer *w, int joint)
{
	return w->m->jnt_type[joint] == mjJNT_HINGE || w->m->jnt_type[joint] == mjJNT_SLIDE;
}

// True if limits, springs, dampers, friction, rotors or servos act along the joint.
static bool acts(const writer *w, int joint)
{
	const mjModel *m = w->m;
	const int dof = m->jnt_dofadr[joint];
	return m->jnt_limited[joint] || m->jnt_stiffness[joint] > 0 || m->dof_damping[dof] > 0 ||
	       m->dof_frictionloss[dof] > 0 || m->dof_armature[dof] > 0 || servo_of(w, joint) >= 0;
}

// True if a scene may have the limits (call_joint.c).
static bool limits_fit(const writer *w, int joint, double low, double high)
{
	const double turn = 2 * M_PI, widest = 6.2, widest_ball = 3;
	if (w->m->jnt_type[joint] == mjJNT_BALL)
		return high > 0 && high <= widest_ball;
	return low <= high &&
	       (w->m->jnt_type[joint] != mjJNT_HINGE || (low >= -turn && high <= turn && high - low <= widest));
}

// Lists what a joint has and obsim's has not.
static void list_lost(writer *w, int joint)
{
	const mjModel *m = w->m;
	const int dof = m->jnt_dofadr[joint];
	const char *name = name_of(w, mjOBJ_JOINT, "joint", joint);
	const bool ball = m->jnt_type[joint] == mjJNT_BALL, free = m->jnt_type[joint] == mjJNT_FREE;
	const double start = ball ? 0 : m->qpos0[m->jnt_qposadr[joint]], *range = m->jnt_range + 2 * joint;
	if (m->jnt_limited[joint] && !limits_fit(w, joint, range[0] - start, range[1] - start))
		leave_out(w, "%s: its limits, %.4g to %.4g, are left out", name, range[0], range[1]);
	if (ball && m->dof_frictionloss[dof] > 0)
		leave_out(w, "%s: its frictionloss, %.4g, is left out", name, m->dof_frictionloss[dof]);
	if (free && m->dof_armature[dof] > 0)
		leave_out(w, "%s: its armature, %.4g, is left out", name, m->dof_armature[dof]);
}

static void write_number(const writer *w, const char *key, double x)
{
	fprintf(w->out, ", %s = %.17g", key, x);
}

// Writes the servo as a motor: MuJoCo's force with a control of 0.
static void write_servo(const writer *w, int servo, double start)
{
	const mjModel *m = w->m;
	const double *bias = m->actuator_biasprm + mjNBIAS * servo, gear = m->actuator_gear[6 * servo];
	const double *range = m->actuator_forcerange + 2 * servo;
	fprintf(w->out, ", motor = { to = %.17g, stiffness = %.17g", -bias[0] / (bias[1] * gear) - start,
		-bias[1] * gear * gear);
	if (bias[2] < 0)
		write_number(w, "damping", -bias[2] * gear * gear);
	if (m->actuator_forcelimited[servo])
		write_number(w, "most", fabs(gear) * fmin(range[1], -range[0]));
	fputs(" }", w->out);
}

// Writes what acts along a hinge or a slider. Values are 0 as the scene begins.
static void write_axis(const writer *w, int joint)
{
	const mjModel *m = w->m;
	const int dof = m->jnt_dofadr[joint], servo = servo_of(w, joint);
	const double start = m->qpos0[m->jnt_qposadr[joint]], *range = m->jnt_range + 2 * joint;
	if (m->jnt_limited[joint] && limits_fit(w, joint, range[0] - start, range[1] - start)) {
		write_number(w, "low", range[0] - start);
		write_number(w, "high", range[1] - start);
	}
	if (m->jnt_stiffness[joint] > 0) {
		write_number(w, "stiffness", m->jnt_stiffness[joint]);
		write_number(w, "rest", m->qpos_spring[m->jnt_qposadr[joint]] - start);
	}
	if (m->dof_damping[dof] > 0)
		write_number(w, "damping", m->dof_damping[dof]);
	if (m->dof_frictionloss[dof] > 0)
		write_number(w, "friction", m->dof_frictionloss[dof]);
	if (m->dof_armature[dof] > 0)
		write_number(w, "armature", m->dof_armature[dof]);
	if (servo >= 0)
		write_servo(w, servo, start);
}

// Writes what acts on the turns of a ball. MuJoCo's ball begins without a turn.
static void write_ball(const writer *w, int joint)
{
	const mjModel *m = w->m;
	const int dof = m->jnt_dofadr[joint];
	const double *range = m->jnt_range + 2 * joint;
	if (m->jnt_limited[joint] && limits_fit(w, joint, 0, range[1]))
		write_number(w, "high", range[1]);
	if (m->jnt_stiffness[joint] > 0)
		write_number(w, "stiffness", m->jnt_stiffness[joint]);
	if (m->dof_damping[dof] > 0)
		write_number(w, "damping", m->dof_damping[dof]);
	if (m->dof_armature[dof] > 0)
		write_number(w, "armature", m->dof_armature[dof]);
}

static ob_vec3 anchor(const writer *w, int joint)
{
	const double *x = w->d->data->xanchor + 3 * joint;
	return ob_v3(x[0], x[1], x[2]);
}

static ob_vec3 axis(const writer *w, int joint)
{
	const double *x = w->d->data->xaxis + 3 * joint;
	return ob_v3(x[0], x[1], x[2]);
}

static void write_ends(const writer *w, const char *kind, const char *child, const char *parent)
{
	fprintf(w->out, "%s { \"%s\"", kind, child);
	if (parent)
		fprintf(w->out, ", \"%s\"", parent);
}

// True if the scene may have the name.
static bool is_clean(const char *name)
{
	size_t n = 0;
	for (; name && name[n]; n++)
		if (name[n] < ' ' || name[n] > '~' || strchr("#\"\\", name[n]))
			return false;
	return n > 0 && n < NAME;
}

static bool reads_joint(const writer *w, int sensor)
{
	return w->m->sensor_type[sensor] == mjSENS_JOINTPOS || w->m->sensor_type[sensor] == mjSENS_JOINTVEL;
}

// Writes a name of the model, or the kind and number.
static void write_name(const writer *w, int type, const char *kind, int id)
{
	const char *name = mj_id2name(w->m, type, id);
	if (is_clean(name))
		fprintf(w->out, "\"%s\"", name);
	else
		fprintf(w->out, "\"%s %d\"", kind, id);
}

// Names a joint that an encoder reads.
static void name_joint(writer *w, int joint)
{
	for (int i = 0; i < w->m->nsensor; i++)
		w->sensed[joint] |= reads_joint(w, i) && w->m->sensor_objid[i] == joint;
	if (!w->sensed[joint])
		return;
	fputs(", name = ", w->out);
	write_name(w, mjOBJ_JOINT, "joint", joint);
}

static void write_joint(writer *w, int joint, const char *child, const char *parent)
{
	const int type = w->m->jnt_type[joint];
	write_ends(w, type == mjJNT_BALL ? "ball" : type == mjJNT_SLIDE ? "slider" : "hinge", child, parent);
	write_vec(w, ", at", anchor(w, joint));
	if (type == mjJNT_BALL) {
		write_ball(w, joint);
	} else {
		write_vec(w, ", axis", axis(w, joint));
		write_axis(w, joint);
		name_joint(w, joint);
	}
	fputs(" }\n", w->out);
}

// True if all joints of the body are hinges through one point.
static bool meet(const writer *w, int body)
{
	const mjModel *m = w->m;
	const int first = m->body_jntadr[body];
	for (int j = first; j < first + m->body_jntnum[body]; j++)
		if (m->jnt_type[j] != mjJNT_HINGE || ob_norm(ob_sub(anchor(w, j), anchor(w, first))) > 1e-9)
			return false;
	return true;
}

static bool any_acts(const writer *w, int body)
{
	bool any = false;
	for (int j = w->m->body_jntadr[body]; j < w->m->body_jntadr[body] + w->m->body_jntnum[body]; j++)
		any |= acts(w, j);
	return any;
}

// A light ball between two joints of one body, which nothing touches.
static void write_link(writer *w, int body, int joint, char name[NAME])
{
	const double mass = link_share * w->m->body_mass[body], *i = w->m->body_inertia + 3 * body;
	const double moment = link_share * fmax(i[0], fmax(i[1], i[2])), radius = sqrt(2.5 * moment / mass);
	snprintf(name, NAME, "link %d", ++w->links);
	fprintf(w->out, "sphere { name = \"%s\", radius = %.17g, mass = %.17g", name, radius, mass);
	write_vec(w, ", at", anchor(w, joint));
	fputs(", hits = {} }\n", w->out);
}

// Joints of a body to what it hangs on. The first joint of the model is the one next to the parent.
static void write_joints(writer *w, int body)
{
	const mjModel *m = w->m;
	const int child = w->part_of[body], above = w->part_of[m->body_parentid[body]];
	const int first = m->body_jntadr[body], n = m->body_jntnum[body];
	const char *own = w->part[child].name, *parent = above == WORLD ? NULL : w->part[above].name;
	for (int j = first; j < first + n; j++)
		list_lost(w, j);
	for (int i = 0; i < w->parts; i++) // the standing parts of its parent; the world's touch it
		if (w->part[i].geom >= 0 && w->part[i].body == m->body_parentid[body] && w->part[i].body)
			keep_apart(w, child, i);
	if (n && m->jnt_type[first] == mjJNT_FREE)
		return;
	if (above != WORLD && above != child)
		join(w, child, above);
	if (n == 0 && above != WORLD && above != child) {
		write_ends(w, "fixed", own, parent);
		fputs(" }\n", w->out);
	} else if (n == 2 && meet(w, body) && fabs(ob_dot(axis(w, first), axis(w, first + 1))) < 1e-12) {
		write_ends(w, "universal", own, parent);
		write_vec(w, ", at", anchor(w, first));
		write_vec(w, ", axis", axis(w, first + 1));
		write_vec(w, ", across", axis(w, first));
		write_axis(w, first + 1);
		if (acts(w, first)) {
			fputs(", second = { restitution = 0", w->out);
			write_axis(w, first);
			fputs(" }", w->out);
		}
		fputs(" }\n", w->out);
	} else if (n == 3 && meet(w, body) && !any_acts(w, body)) {
		write_ends(w, "ball", own, parent);
		write_vec(w, ", at", anchor(w, first));
		fputs(" }\n", w->out);
	} else if (n) {
		char link[NAME], last[NAME];
		snprintf(last, NAME, "%s", parent ? parent : "");
		for (int j = first; j < first + n - 1; j++) {
			write_link(w, body, j, link);
			write_joint(w, j, link, *last ? last : NULL);
			snprintf(last, NAME, "%s", link);
		}
		write_joint(w, first + n - 1, own, *last ? last : NULL);
		if (n > 1)
			leave_out(w, "%s: its %d joints have %d balls of a millionth of its mass between them", own, n,
				  n - 1);
		if (n > 1 && above != WORLD)
			fprintf(w->out, "apart { \"%s\", \"%s\" }\n", own, parent);
	}
}

// Closes loops: equality constraints that obsim has as joints.
static void write_equalities(writer *w)
{
	const mjModel *m = w->m;
	for (int i = 0; i < m->neq; i++) {
		const int type = m->eq_type[i];
		const char *name = name_of(w, mjOBJ_EQUALITY, "equality", i);
		if ((type != mjEQ_CONNECT && type != mjEQ_WELD) || !m->eq_active[i]) {
			leave_out(w, "%s is left out", name);
			continue;
		}
		const int one = w->part_of[m->eq_obj1id[i]], other = w->part_of[m->eq_obj2id[i]];
		const int a = one == WORLD ? other : one, b = one == WORLD ? WORLD : other;
		if (a == b || a == WORLD) {
			leave_out(w, "%s is left out: both of its bodies stand still", name);
			continue;
		}
		write_ends(w, type == mjEQ_WELD ? "fixed" : "ball", w->part[a].name,
			   b == WORLD ? NULL : w->part[b].name);
		if (type == mjEQ_CONNECT) {
			const double *x = w->d->data->xpos + 3 * m->eq_obj1id[i],
				     *r = w->d->data->xmat + 9 * m->eq_obj1id[i];
			double at[3];
			mju_rotVecMat(at, m->eq_data + mjNEQDATA * i, r);
			write_vec(w, ", at", ob_v3(x[0] + at[0], x[1] + at[1], x[2] + at[2]));
		}
		if (b != WORLD && !are_joined(w, a, b))
			fputs(", collide = true", w->out);
		fputs(" }\n", w->out);
	}
}

// ---- pairs that do not touch

static void write_excluded(writer *w)
{
	const mjModel *m = w->m;
	for (int i = 0; i < m->nexclude; i++) {
		const int one = (m->exclude_signature[i] >> 16) - 1, other = (m->exclude_signature[i] & 0xffff) - 1;
		for (int a = 0; a < w->parts; a++)
			for (int b = 0; b < w->parts; b++)
				if (w->part[a].body == one && w->part[b].body == other &&
				    (w->part[a].geom < 0 || w->part[b].geom < 0))
					keep_apart(w, a, b);
	}
}

// Solid k of an object: a compound has one for each part.
static ob_solid solid_of(const part *p, uint32_t k)
{
	const ob_imported_solid *s = &p->solid;
	if (ob_solid_is_compound(s))
		return ob_solid_of(s->shape, ob_hull_size(s->hull + 1 + k), s->pose, s->hull + 1 + k);
	ob_solid out = { s->shape, s->size, s->pose.p, ob_quat_matrix(s->pose.q), s->hull };
	if (!s->hull)
		return out;
	out.size = ob_hull_size(out.hull);
	const ob_mat3 r = out.r;
	out.p = ob_add(out.p, ob_rotate(&r, s->hull->centre));
	out.r = ob_quat_matrix(ob_quat_mul(s->pose.q, s->hull->frame));
	return out;
}

// Greatest depth (m) of a solid of one in a solid of the other; below 0: they are apart.
static double depth_of(const part *one, const part *other)
{
	double most = -1;
	for (uint32_t i = 0; i <= one->solid.pieces - (one->solid.pieces > 0); i++)
		for (uint32_t k = 0; k <= other->solid.pieces - (other->solid.pieces > 0); k++) {
			const ob_solid x = solid_of(one, i), y = solid_of(other, k);
			most = fmax(most, ob_depth(&x, &y));
		}
	return most;
}

// True if it is not exactly the shape of its geometries.
static bool is_rough(const ob_imported_solid *s)
{
	return s->inside > 0 || (s->geoms > 1 && s->pieces == 1);
}

// Hulls may overlap where the geometries that they stand for do not.
static void part_overlaps(writer *w)
{
	for (int a = 0; a < w->parts; a++)
		for (int b = 0; b < a; b++) {
			const part *one = &w->part[a], *other = &w->part[b];
			const bool moves = one->geom < 0 || other->geom < 0;
			const bool rough = is_rough(&one->solid) || is_rough(&other->solid);
			if (!moves || !rough || !touch(one, other) || are_joined(w, a, b))
				continue;
			const double depth = depth_of(one, other);
			if (!(depth > 0))
				continue;
			keep_apart(w, a, b);
			leave_out(w, "%s and %s do not collide: their hulls overlap by %.2g m as the scene begins",
				  one->name, other->name, depth);
		}
}

// ---- sensors

// First sensor of one of two types on the same thing; n: there is none.
static int first_of(const writer *w, int type, int other, int id)
{
	int i = 0;
	while (i < w->m->nsensor &&
	       ((w->m->sensor_type[i] != type && w->m->sensor_type[i] != other) || w->m->sensor_objid[i] != id))
		i++;
	return i;
}

static void write_noise(const writer *w, const char *key, int type, int id)
{
	const int i = first_of(w, type, type, id);
	if (i < w->m->nsensor && w->m->sensor_noise[i] > 0)
		write_number(w, key, w->m->sensor_noise[i]);
}

// Writes the pose of a site in its object's frame.
static void write_site(const writer *w, int site, const part *p, bool along_z)
{
	double q[4];
	const double *x = w->d->data->site_xpos + 3 * site;
	const ob_mat3 r = ob_quat_matrix(p->solid.pose.q);
	ob_pose at = { .p = ob_rotate_back(&r, ob_sub(ob_v3(x[0], x[1], x[2]), p->solid.pose.p)) };
	mju_mat2Quat(q, w->d->data->site_xmat + 9 * site);
	at.q = ob_quat_mul(ob_quat_conjugate(p->solid.pose.q), (ob_quat){ q[0], q[1], q[2], q[3] });
	if (along_z) // the first beam of a lidar is along x
		at.q = ob_quat_mul(at.q, (ob_quat){ M_SQRT1_2, 0, -M_SQRT1_2, 0 });
	write_vec(w, ", at", at.p);
	fprintf(w->out, ", q = { %.17g, %.17g, %.17g, %.17g }", at.q.w, at.q.x, at.q.y, at.q.z);
}

// Writes a sensor, as far as the scene has one. Two that read the same thing become one.
static void write_sensor(writer *w, int i)
{
	const mjModel *m = w->m;
	const int type = m->sensor_type[i], id = m->sensor_objid[i];
	const bool turns = type == mjSENS_ACCELEROMETER || type == mjSENS_GYRO, encodes = reads_joint(w, i);
	const int first = turns     ? first_of(w, mjSENS_ACCELEROMETER, mjSENS_GYRO, id)
			  : encodes ? first_of(w, mjSENS_JOINTPOS, mjSENS_JOINTVEL, id)
				    : i;
	const bool on_site = turns || type == mjSENS_TOUCH || type == mjSENS_RANGEFINDER;
	const int on = on_site ? w->part_of[m->site_bodyid[id]] : WORLD;
	const char *name = mj_id2name(m, mjOBJ_SENSOR, i);
	if (first < i)
		return;
	if (encodes ? !w->sensed[id] : on == WORLD) {
		leave_out(w, "%s is left out", name_of(w, mjOBJ_SENSOR, "sensor", i));
		return;
	}
	if (encodes) {
		fputs("encoder { joint = ", w->out);
		write_name(w, mjOBJ_JOINT, "joint", id);
		write_noise(w, "noise", mjSENS_JOINTPOS, id);
		write_noise(w, "rate_noise", mjSENS_JOINTVEL, id);
	} else {
		const part *p = &w->part[on];
		fprintf(w->out, "%s { on = \"%s\"", turns ? "imu" : type == mjSENS_TOUCH ? "touch" : "lidar", p->name);
		if (type != mjSENS_TOUCH)
			write_site(w, id, p, !turns);
		if (turns) {
			write_noise(w, "noise", mjSENS_ACCELEROMETER, id);
			write_noise(w, "gyro_noise", mjSENS_GYRO, id);
		} else {
			write_noise(w, "noise", type, id);
		}
		if (type == mjSENS_RANGEFINDER) {
			fputs(", beams = 1", w->out);
			write_number(w, "reach", m->sensor_cutoff[i] > 0 ? m->sensor_cutoff[i] : 1e6);
		}
		if (type == mjSENS_TOUCH)
			leave_out(w, "%s reads all contacts of its object, not those at its site alone",
				  name_of(w, mjOBJ_SENSOR, "sensor", i));
	}
	if (is_clean(name))
		fprintf(w->out, ", name = \"%s\"", name);
	fputs(" }\n", w->out);
}

// ---- the rest of the model

static void list_kind(writer *w, int type, const char *kind, int n)
{
	for (int i = 0; i < n; i++)
		leave_out(w, "%s is left out", name_of(w, type, kind, i));
}

static void list_rest(writer *w)
{
	const mjModel *m = w->m;
	for (int a = 0; a < m->nu; a++)
		if (m->actuator_trntype[a] != mjTRN_JOINT || !has_one_axis(w, m->actuator_trnid[2 * a]) ||
		    servo_of(w, m->actuator_trnid[2 * a]) != a)
			leave_out(w, "%s is left out", name_of(w, mjOBJ_ACTUATOR, "actuator", a));
	list_kind(w, mjOBJ_TENDON, "tendon", m->ntendon);
	list_kind(w, mjOBJ_PAIR, "contact pair", m->npair);
	list_kind(w, mjOBJ_CAMERA, "camera", m->ncam);
	list_kind(w, mjOBJ_LIGHT, "light", m->nlight);
	list_kind(w, mjOBJ_SKIN, "skin", m->nskin);
	list_kind(w, mjOBJ_KEY, "keyframe", m->nkey);
	if (m->opt.density > 0 || m->opt.viscosity > 0)
		leave_out(w, "density and viscosity of the air are left out");
	for (int body = 1; body < m->nbody; body++)
		if (m->body_mocapid[body] >= 0)
			leave_out(w, "%s stands still: it is a mocap body", name_of(w, mjOBJ_BODY, "body", body));
}

static void write_scene(writer *w, const char *path)
{
	const mjModel *m = w->m;
	const char *file = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
	char title[100];
	snprintf(title, sizeof title, "%.90s", file);
	for (char *c = title; *c; c++)
		if (*c == '"' || *c == '\\' || (unsigned char)*c < ' ' || (unsigned char)*c > '~')
			*c = '_';
	fprintf(w->out, "scene { title = \"%s\"", title);
	const double pull = m->opt.disableflags & mjDSBL_GRAVITY ? 0 : 1;
	write_vec(w, ", gravity", ob_scale(ob_v3(m->opt.gravity[0], m->opt.gravity[1], m->opt.gravity[2]), pull));
	fputs(" }\n\n", w->out);
	collect(w);
	const int groups = number_groups(w);
	for (int i = 0; i < w->parts; i++)
		write_part(w, &w->part[i], groups);
	fputs("\n", w->out);
	for (int body = 1; body < m->nbody; body++)
		if (w->part_of[body] != WORLD && w->part[w->part_of[body]].body == body)
			write_joints(w, body);
	write_equalities(w);
	write_excluded(w);
	part_overlaps(w);
	for (int i = 0; i < m->nsensor; i++)
		write_sensor(w, i);
	list_rest(w);
}

static bool convert(const char *path, const char *folder, FILE *scene, FILE *omitted, ob_error *e)
{
	ob_drawn d;
	if (!ob_drawn_load(path, folder != NULL, omitted, &d, e))
		return false;
	writer w = { .d = &d, .m = d.model, .out = scene, .omitted = omitted, .folder = folder };
	w.part_of = calloc((size_t)d.model->nbody, sizeof *w.part_of);
	w.sensed = calloc((size_t)d.model->njnt + 1, sizeof *w.sensed);
	if (!w.part_of || !w.sensed)
		return ob_fail(e, "%s: out of memory", path);
	write_scene(&w, path);
	return true; // its memory ends with the process
}

OB_PART(ob_import_part) = { OB_PART_HEAD(ob_import_part), .convert = convert };
