// Draws a running universe as a picture (PPM), a ray for each pixel: sketch NAME EYE-X EYE-Y EYE-Z > picture.ppm. The eye looks
// at the origin. It draws spheres, boxes and planes; other shapes as the sphere around them.
// cc sketch.c $(pkg-config --cflags --libs obsim) -lm -o sketch
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <ob/motion.h>
#include <ob/universe.h>

enum { WIDTH = 480, HEIGHT = 270 };
static const double widest = 1e9; // m
static const ob_vec3 sun = { .4, -.5, .77 };

typedef struct thing {
	ob_passport passport;
	ob_mat3 frame; // body to world
	ob_vec3 at; // m
} thing;

typedef struct hit {
	double t; // m along the ray
	ob_vec3 normal; // world
	const thing *thing;
} hit;

static void meet_sphere(const thing *s, ob_vec3 from, ob_vec3 ray, double radius, hit *h)
{
	const ob_vec3 d = ob_sub(s->at, from);
	const double along = ob_dot(d, ray), q = along * along - ob_norm2(d) + radius * radius,
		     t = along - sqrt(fmax(q, 0));
	if (q > 0 && t > 0 && t < h->t)
		*h = (hit){ t, ob_scale(ob_sub(ob_madd(from, t, ray), s->at), 1 / radius), s };
}

static void meet_plane(const thing *p, ob_vec3 from, ob_vec3 ray, hit *h)
{
	const ob_vec3 n = ob_column(&p->frame, 2);
	const double t = ob_dot(ob_sub(p->at, from), n) / ob_dot(ray, n);
	if (t > 0 && t < h->t)
		*h = (hit){ t, n, p };
}

// The slab method, in the frame of the box.
static void meet_box(const thing *b, ob_vec3 from, ob_vec3 ray, hit *h)
{
	const ob_vec3 o = ob_rotate_back(&b->frame, ob_sub(from, b->at)), d = ob_rotate_back(&b->frame, ray);
	const double start[3] = { o.x, o.y, o.z }, way[3] = { d.x, d.y, d.z },
		     half[3] = { b->passport.size.x, b->passport.size.y, b->passport.size.z };
	double enter = 0, leave = h->t;
	int axis = -1;
	for (int i = 0; i < 3; i++) {
		const double near = (-copysign(half[i], way[i]) - start[i]) / way[i],
			     far = (copysign(half[i], way[i]) - start[i]) / way[i];
		axis = near > enter ? i : axis;
		enter = fmax(enter, near);
		leave = fmin(leave, far);
	}
	if (axis >= 0 && enter < leave)
		*h = (hit){ enter, ob_scale(ob_column(&b->frame, axis), way[axis] > 0 ? -1 : 1), b };
}

static void meet(const thing *o, ob_vec3 from, ob_vec3 ray, hit *h)
{
	if (o->passport.shape == OB_SHAPE_PLANE)
		meet_plane(o, from, ray, h);
	else if (o->passport.shape == OB_SHAPE_BOX)
		meet_box(o, from, ray, h);
	else
		meet_sphere(o, from, ray, ob_shape_radius(o->passport.shape, o->passport.size), h);
}

static void draw_pixel(const thing *all, size_t n, ob_vec3 from, ob_vec3 ray)
{
	hit h = { .t = widest };
	for (size_t i = 0; i < n; i++)
		meet(&all[i], from, ray, &h);
	const double light = h.thing ? .25 + .75 * fmax(0, ob_dot(h.normal, sun)) : 1;
	static const float sky[3] = { .55f, .7f, .9f };
	for (int c = 0; c < 3; c++)
		putchar((int)(255 * pow(fmin(1, light * (h.thing ? h.thing->passport.colour[c] : sky[c])), 1 / 2.2)));
}

static void draw(const thing *all, size_t n, ob_vec3 eye)
{
	const ob_vec3 ahead = ob_scale(eye, -1 / ob_norm(eye)), side = ob_cross(ahead, ob_v3(0, 0, 1)),
		      right = ob_scale(side, 1 / ob_norm(side)), up = ob_cross(right, ahead);
	printf("P6 %d %d 255\n", WIDTH, HEIGHT);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const double a = (x - .5 * WIDTH) / HEIGHT, b = (.5 * HEIGHT - y) / HEIGHT;
			const ob_vec3 ray = ob_madd(ob_madd(ahead, a, right), b, up);
			draw_pixel(all, n, eye, ob_scale(ray, 1 / ob_norm(ray)));
		}
}

int main(int argc, char **argv)
{
	ob_error e = { "usage: sketch NAME EYE-X EYE-Y EYE-Z" };
	ob_universe *u = argc == 5 ? ob_universe_attach(argv[1], &e) : NULL;
	if (!u) {
		fprintf(stderr, "sketch: %s\n", e.text);
		return 1;
	}
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	thing *all = calloc(info.capacity, sizeof *all);
	size_t n = 0;
	for (uint32_t id = 0; all && id < info.capacity; id++) {
		thing *o = &all[n];
		ob_motion m;
		if (!ob_universe_get_passport(u, id, &o->passport) || !ob_universe_get_motion(u, id, &m))
			continue; // the id is free
		const ob_state now = ob_motion_at(&m, o->passport.inertia, info.time);
		o->at = now.pose.p;
		o->frame = ob_quat_matrix(now.pose.q);
		n++;
	}
	draw(all, n, ob_v3(strtod(argv[2], NULL), strtod(argv[3], NULL), strtod(argv[4], NULL)));
	free(all);
	ob_universe_detach(u);
	return 0;
}
