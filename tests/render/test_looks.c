// Objects with meshes: a mesh of a cube gives the picture of the cube, with any collision shape; sources of its
// colours, and effects of its images.
#include <string.h>

#include "canvas.h"
#include "hull/hull.h"
#include "render/mesh.h"

static const float red[3] = { .7f, .05f, .04f }, green[3] = { .04f, .5f, .06f };

static ob_camera_def camera(void)
{
	return test_scene_camera(ob_v3(3, -7, 4), ob_v3(0, 0, 1));
}

// Faces of a cube as a hull has them, at distance half (m) from the origin.
static ob_hull hull_of_cube(double half)
{
	ob_vec3 corner[8];
	ob_hull h;
	ob_error e;
	for (int i = 0; i < 8; i++)
		corner[i] = ob_v3(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half);
	CHECK(ob_hull_build(corner, 8, &h, &e));
	return h;
}

static ob_mesh mesh_of_hull(const ob_hull *h, const float colour[3], float surface)
{
	ob_vertex vertex[3 * OB_HULL_FACES_MAX];
	ob_mesh m = { .vertices = ob_mesh_of_hull(h, vertex) };
	m.indices = m.vertices;
	m.vertex = calloc(m.vertices, sizeof *m.vertex);
	m.index = calloc(m.vertices, sizeof *m.index);
	for (uint32_t i = 0; i < m.vertices; i++) {
		memcpy(m.vertex[i].position, vertex[i].corner, sizeof vertex[i].corner);
		memcpy(m.vertex[i].normal, vertex[i].normal, sizeof vertex[i].normal);
		memcpy(m.vertex[i].colour, colour, 3 * sizeof *colour);
		m.vertex[i].surface = surface;
		m.index[i] = i;
	}
	CHECK(ob_mesh_makes_sense(&m));
	return m;
}

// Gives the whole mesh one image of colours and one of roughness and metal, each of a single pixel.
static void put_images(ob_mesh *m, const uint8_t colour[4], const uint8_t surface[4])
{
	m->image = calloc(2, sizeof *m->image);
	m->part = calloc(1, sizeof *m->part);
	m->images = 2;
	m->parts = 1;
	m->image[0] = (ob_mesh_image){ 1, 1, memcpy(malloc(4), colour, 4) };
	m->image[1] = (ob_mesh_image){ 1, 1, memcpy(malloc(4), surface, 4) };
	m->part[0] = (ob_mesh_part){ .indices = m->indices, .colour = 1, .surface = 2 };
	CHECK(ob_mesh_makes_sense(m));
}

static const ob_mesh *looks; // for the next picture
static uint32_t looks_count;

// One object of this shape and colour on the ground, tilted.
static uint8_t *picture(ob_shape shape, ob_vec3 size, const float colour[3], uint8_t mesh, uint32_t flags,
			ob_hull *hull)
{
	ob_render_setup setup = { .width = CANVAS_WIDTH, .height = CANVAS_HEIGHT, .samples = 4 };
	const ob_look_def look = test_scene_look();
	const ob_camera_def from = camera();
	ob_error e = { "" };
	ob_snapshot s;
	setup.mesh = looks;
	setup.meshes = looks_count;
	canvas c = { ob_renderer_create(&setup, &look, &e), malloc(4 * CANVAS_WIDTH * CANVAS_HEIGHT) };
	if (!c.renderer) {
		fprintf(stderr, "skipped: %s\n", e.text);
		exit(77);
	}
	test_scene_start(&s, 1);
	test_scene_add(&s, shape, size, ob_v3(0, 0, 1.6), ob_quat_turn(ob_quat_identity(), ob_v3(.4, .2, .7)), colour);
	s.passport[1].mesh = mesh;
	s.passport[1].flags |= flags;
	s.passport[1].roughness = .25f; // a whole surface, as vertices have it
	s.hulls = hull ? 1 : 0;
	s.hull = &hull;
	canvas_draw(&c, NULL, &s, 0, &from);
	test_scene_finish(&s);
	ob_renderer_destroy(c.renderer);
	return c.rgba;
}

static bool same(const uint8_t *a, const uint8_t *b)
{
	return memcmp(a, b, 4 * CANVAS_WIDTH * CANVAS_HEIGHT) == 0;
}

// Mean difference of a channel, of 255.
static double difference(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;
	for (int i = 0; i < 4 * CANVAS_WIDTH * CANVAS_HEIGHT; i++)
		sum += abs(a[i] - b[i]);
	return sum / (4 * CANVAS_WIDTH * CANVAS_HEIGHT);
}

int main(void)
{
	ob_hull cube = hull_of_cube(1);
	ob_mesh mesh[4] = { mesh_of_hull(&cube, red, ob_surface_pack(.25f, 0)),
			    mesh_of_hull(&cube, (const float[3]){ -1, -1, -1 }, -1),
			    mesh_of_hull(&cube, (const float[3]){ 1, .1f, .4f }, ob_surface_pack(.5f, 1)),
			    mesh_of_hull(&cube, (const float[3]){ -1, -1, -1 }, -1) };
	// sRGB of .7, of .5, which a tenth of makes .05, and of .1; half of the roughness, and no metal
	static const uint8_t colours[4] = { 218, 188, 89, 0 }, surfaces[4] = { 9, 128, 0, 0 };
	const ob_vec3 round = ob_v3(.7, 0, 0), box = ob_v3(1, 1, 1);
	enum { BOTH = OB_OBJECT_MESH_COLOUR | OB_OBJECT_MESH_SURFACE };
	uint8_t *as_box = picture(OB_SHAPE_BOX, box, red, 0, 0, NULL);
	uint8_t *as_hull = picture(OB_SHAPE_HULL, ob_hull_size(&cube), red, 0, 0, &cube);
	uint8_t *as_ball = picture(OB_SHAPE_SPHERE, round, red, 0, 0, NULL);
	uint8_t *sensor = picture(OB_SHAPE_BOX, box, red, 0, OB_OBJECT_SENSOR, NULL);
	uint8_t *hidden = picture(OB_SHAPE_BOX, box, red, 0, OB_OBJECT_HIDDEN, NULL);
	uint8_t *none = picture(OB_SHAPE_SPHERE, round, green, 0, OB_OBJECT_HIDDEN | OB_OBJECT_SENSOR, NULL);
	looks = mesh;
	looks_count = 4;
	put_images(&mesh[2], colours, surfaces);
	put_images(&mesh[3], colours, surfaces);
	uint8_t *by_mesh = picture(OB_SHAPE_SPHERE, round, green, 1, BOTH, NULL);
	uint8_t *by_object = picture(OB_SHAPE_SPHERE, round, red, 1, 0, NULL);
	uint8_t *unpainted = picture(OB_SHAPE_SPHERE, round, red, 2, BOTH, NULL);
	uint8_t *other = picture(OB_SHAPE_SPHERE, round, green, 1, OB_OBJECT_MESH_SURFACE, NULL);
	uint8_t *among_hulls = picture(OB_SHAPE_HULL, ob_hull_size(&cube), red, 2, 0, &cube);
	uint8_t *beyond = picture(OB_SHAPE_SPHERE, round, red, 5, BOTH, NULL);
	uint8_t *by_images = picture(OB_SHAPE_SPHERE, round, green, 3, BOTH, NULL);
	uint8_t *own_colour = picture(OB_SHAPE_SPHERE, round, red, 3, OB_OBJECT_MESH_SURFACE, NULL);
	uint8_t *own_surface = picture(OB_SHAPE_SPHERE, round, green, 3, OB_OBJECT_MESH_COLOUR, NULL);
	uint8_t *no_paint = picture(OB_SHAPE_SPHERE, round, red, 4, BOTH, NULL);
	CHECK(same(by_mesh, as_hull) && same(by_object, as_hull) && same(unpainted, as_hull) &&
	      same(among_hulls, as_hull));
	printf("%g %g\n", difference(by_mesh, as_box), difference(as_ball, as_box));
	CHECK(difference(by_mesh, as_box) < .1 * difference(as_ball, as_box)); // a box has rounded edges
	CHECK(difference(other, as_hull) > 1);
	CHECK(same(beyond, as_ball)); // an unknown mesh is not drawn: the collision shape is
	printf("%g %g %g\n", difference(by_images, as_hull), difference(own_colour, as_hull),
	       difference(own_surface, as_hull));
	CHECK(difference(by_images, as_hull) < .1 && difference(own_colour, as_hull) < .1 &&
	      difference(own_surface, as_hull) < .1);
	CHECK(same(no_paint, as_hull)); // images multiply the mesh's paint, and it has none
	CHECK(same(hidden, none)); // neither the object nor its shadow
	printf("%g %g\n", difference(sensor, none), difference(as_box, none));
	CHECK(difference(sensor, none) > .5 &&
	      difference(sensor, none) < .4 * difference(as_box, none)); // it is seen through
	uint8_t *const all[] = { sensor,    hidden, none,        as_box, as_hull,   as_ball,    by_mesh,     by_object,
				 unpainted, other,  among_hulls, beyond, by_images, own_colour, own_surface, no_paint };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	for (int i = 0; i < 4; i++)
		ob_mesh_finish(&mesh[i]);
	return check_end();
}
