#include "render/bodies.h"

#include <stdlib.h>

static const double bevel_share = .1, bevel_most = .05; // of the smallest half size; m
static const double medium_px = 7, fine_px = 45; // radius on the screen from which rounder meshes are used

// Where object i is at t. Between two publications the older one is needed; without it the body stands where the
// newer one begins.
static ob_pose pose_at(const ob_snapshot *prev, const ob_snapshot *now, uint32_t i, double t)
{
	const ob_motion *m = &now->motion[i];
	ob_vec3 inertia = now->passport[i].inertia;
	if (t >= m->t0)
		return ob_motion_at(m, inertia, t).pose;
	bool same = prev && i < prev->count && (prev->passport[i].flags & OB_OBJECT_PRESENT) &&
		    prev->passport[i].generation == now->passport[i].generation && prev->motion[i].t0 <= t;
	if (!same)
		return (ob_pose){ m->p, m->q };
	ob_motion before = prev->motion[i];
	if (before.t0 < prev->time && !(m->flags & OB_MOTION_FREE)) { // it flew so far, and what came then is not known
		ob_pose then = ob_motion_at(&before, inertia, prev->time).pose;
		before.p = then.p;
		before.q = then.q;
		before.t0 = prev->time;
	}
	return ob_motion_between(&before, m, inertia, t);
}

bool ob_bodies_evaluate(ob_bodies *b, const ob_snapshot *prev, const ob_snapshot *now, double t)
{
	if (now->count > b->capacity) {
		ob_render_body *grown = realloc(b->body, now->count * sizeof *grown);
		if (!grown)
			return false;
		b->body = grown;
		b->capacity = now->count;
	}
	b->now = now;
	b->count = 0;
	b->planes = 0;
	for (uint32_t i = 0; i < now->count; i++) {
		const ob_passport *p = &now->passport[i];
		if (!(p->flags & OB_OBJECT_PRESENT) || p->shape == OB_SHAPE_NONE || p->shape > OB_SHAPE_CYLINDER)
			continue;
		ob_pose pose = pose_at(prev, now, i, t);
		if (p->shape != OB_SHAPE_PLANE) {
			b->body[b->count++] = (ob_render_body){ pose, ob_shape_radius(p->shape, p->size), 0, i };
		} else if (b->planes < OB_PLANES_MAX) {
			b->plane_id[b->planes] = i;
			b->plane[b->planes++] = pose;
		}
	}
	return true;
}

// Equal distances in the order of ids: the same frame gives the same bytes.
static int nearer(const void *a, const void *b)
{
	const ob_render_body *x = a, *y = b;
	if (x->distance != y->distance)
		return x->distance < y->distance ? -1 : 1;
	return x->id < y->id ? -1 : 1;
}

void ob_bodies_sort(ob_bodies *b, ob_vec3 eye)
{
	for (uint32_t i = 0; i < b->count; i++)
		b->body[i].distance = ob_norm2(ob_sub(b->body[i].pose.p, eye));
	qsort(b->body, b->count, sizeof *b->body, nearer);
}

void ob_bodies_finish(ob_bodies *b)
{
	free(b->body);
	*b = (ob_bodies){ 0 };
}

static int mesh_of(const ob_passport *p, const ob_render_body *body, const ob_view *v, int height)
{
	if (p->shape == OB_SHAPE_BOX)
		return OB_MESH_BOX;
	double distance = ob_norm(ob_sub(body->pose.p, v->eye));
	double px = .5 * height * p->size.x / (v->tan_y * fmax(distance, v->near_plane));
	int level = px < medium_px ? 0 : px < fine_px ? 1 : 2;
	return (p->shape == OB_SHAPE_CYLINDER ? OB_MESH_CYLINDER : OB_MESH_ROUND) + level;
}

static double bevel(double smallest)
{
	return fmin(bevel_share * smallest, bevel_most);
}

static void set(float to[4], double x, double y, double z, double w)
{
	to[0] = (float)x;
	to[1] = (float)y;
	to[2] = (float)z;
	to[3] = (float)w;
}

static ob_instance instance_of(const ob_passport *p, const ob_pose *pose, ob_vec3 eye)
{
	ob_instance i;
	ob_vec3 at = ob_sub(pose->p, eye), size = p->size;
	double r = size.x, rounding = 0;
	ob_vec3 core = { 0, 0, 0 };
	if (p->shape == OB_SHAPE_BOX) {
		r = 0;
		core = size;
		rounding = bevel(fmin(size.x, fmin(size.y, size.z)));
	} else if (p->shape == OB_SHAPE_CYLINDER) {
		r = bevel(fmin(size.x, size.y));
		core = ob_v3(size.x - r, size.x - r, size.y - r);
	} else if (p->shape == OB_SHAPE_CAPSULE) {
		core.z = size.y;
	}
	set(i.position_radius, at.x, at.y, at.z, r);
	set(i.attitude, pose->q.x, pose->q.y, pose->q.z, pose->q.w);
	set(i.core, core.x, core.y, core.z, rounding);
	for (int k = 0; k < 4; k++)
		i.colour[k] = p->colour[k];
	return i;
}

bool ob_instances_fill(ob_instances *out, const ob_bodies *b, const ob_view *v, int height, ob_body_filter filter,
		       const void *context)
{
	if (b->count > out->capacity) {
		ob_instance *grown = realloc(out->instance, b->count * sizeof *grown);
		if (!grown)
			return false;
		out->instance = grown;
		out->capacity = b->count;
	}
	uint8_t *mesh = malloc(b->count + 1);
	if (!mesh)
		return false;
	uint32_t count[OB_MESHES + 1] = { 0 };
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_render_body *body = &b->body[i];
		bool taken = filter(body, context);
		mesh[i] = taken ? (uint8_t)mesh_of(&b->now->passport[body->id], body, v, height) : OB_MESHES;
		count[mesh[i]]++;
	}
	out->first[0] = 0;
	for (int k = 0; k < OB_MESHES; k++) {
		out->first[k + 1] = out->first[k] + count[k];
		count[k] = out->first[k];
	}
	for (uint32_t i = 0; i < b->count; i++)
		if (mesh[i] < OB_MESHES)
			out->instance[count[mesh[i]]++] =
				instance_of(&b->now->passport[b->body[i].id], &b->body[i].pose, v->eye);
	free(mesh);
	return true;
}

void ob_instances_finish(ob_instances *i)
{
	free(i->instance);
	*i = (ob_instances){ 0 };
}
