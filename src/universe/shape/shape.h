// Shapes: one line each in the table below, and one file each beside it. Other modules ask for properties, and name a
// shape only to build one. Pure functions, thread-safe.
#ifndef OB_SHAPE_SHAPE_H
#define OB_SHAPE_SHAPE_H

#include <ob/hull.h>
#include <ob/motion.h>

typedef enum ob_shape_property {
	OB_UNBOUNDED = 1 << 0, // no size, no end; always static
	OB_ISOTROPIC = 1 << 1, // the same in every attitude
	OB_AXIAL = 1 << 2, // the same however it is turned about z of its frame
	OB_RIMMED = 1 << 3, // axial; flat ends with a rim about each
	OB_CORNERED = 1 << 4, // a polyhedron
	OB_SIDED = 1 << 5, // a polyhedron: its size is half of its sides along the axes
	OB_HULLED = 1 << 6, // a polyhedron: needs an ob_hull
	OB_SURFACED = 1 << 7, // a surface of triangles (terrain/terrain.h), always static
	OB_ROUND = OB_ISOTROPIC | OB_AXIAL,
} ob_shape_property;

// Each shape: its constant in ob_shape, its kind (ob_shape_NAME, in a file of that name), its properties.
#define OB_SHAPES(SHAPE) \
	SHAPE(SPHERE, sphere, OB_ISOTROPIC) \
	SHAPE(BOX, box, OB_CORNERED | OB_SIDED) \
	SHAPE(PLANE, plane, OB_UNBOUNDED) \
	SHAPE(CAPSULE, capsule, OB_AXIAL) \
	SHAPE(CYLINDER, cylinder, OB_AXIAL | OB_RIMMED) \
	SHAPE(HULL, hull, OB_CORNERED | OB_HULLED) \
	SHAPE(TERRAIN, terrain, OB_SURFACED)

#define OB_SHAPE_COUNTED(NAME, name, properties) +1
#define OB_SHAPE_BIT(NAME, name, properties) | (any & (properties) ? 1u << OB_SHAPE_##NAME : 0)

#define OB_SHAPE_TEXT(NAME, name, properties) " " #name
#define OB_SHAPE_NAMES OB_SHAPES(OB_SHAPE_TEXT) // text of all names, in the order of ob_shape, each after a space

enum { OB_SHAPE_KINDS = 1 OB_SHAPES(OB_SHAPE_COUNTED) }; // with OB_SHAPE_NONE, from 0

// True if the shape has any of the properties. One instruction where they are constant; false for an unknown shape.
static inline bool ob_shape_is(ob_shape shape, unsigned any)
{
	return (0u OB_SHAPES(OB_SHAPE_BIT)) >> ((unsigned)shape & 31) & 1;
}

// True for a known shape with a size that can move, and that others can create.
static inline bool ob_shape_is_bounded(ob_shape shape)
{
	return shape != OB_SHAPE_NONE && (unsigned)shape < OB_SHAPE_KINDS &&
	       !ob_shape_is(shape, OB_UNBOUNDED | OB_SURFACED);
}

// Sum of a box with these half extents, a disc across z, and a ball: all points x + y + z with x in the box, y in the
// disc, z in the ball.
typedef struct ob_outline {
	ob_vec3 half; // m
	double rim, ball; // m: radii
} ob_outline;

// Number in the size of a shape, as people give it.
typedef struct ob_shape_key {
	const char *name; // as scenes have it
	int component; // of the size: 0 .. 2; OB_SHAPE_SIDES: all three, as a vector
	double share; // the size's, of what is given: .5 for a length
} ob_shape_key;

enum { OB_SHAPE_KEYS = 2, OB_SHAPE_SIDES = -1 };

// A shape by its functions. size: see ob_shape. Vectors are in the shape's frame; n is of any length but 0.
typedef struct ob_shape_kind {
	const char *name; // as scenes have it
	ob_shape_key key[OB_SHAPE_KEYS]; // without a name: none
	double (*radius)(ob_vec3 size); // the bounding ball
	double (*thickness)(ob_vec3 size); // least width
	double (*longest)(ob_vec3 size); // half of the largest extent along an axis
	double (*extent)(ob_vec3 size, ob_vec3 n); // from the centre along the unit vector n
	ob_vec3 (*farthest)(const ob_vec3 *size, const ob_hull *hull, const ob_vec3 *n); // support point
	ob_outline (*outline)(ob_vec3 size); // NULL: it is no such sum
	double (*volume)(ob_vec3 size); // NULL: as the hull has it, or none
	ob_vec3 (*inertia)(ob_vec3 size, double mass); // principal moments; NULL likewise
	// First distance at which a ray from p along the unit vector d enters, and the normal there; infinity: it does
	// not, or p is inside. NULL: rays pass through.
	double (*enter)(ob_vec3 size, ob_vec3 p, ob_vec3 d, ob_vec3 *n);
} ob_shape_kind;

#define OB_SHAPE_DECLARED(NAME, name, properties) extern const ob_shape_kind ob_shape_##name;
OB_SHAPES(OB_SHAPE_DECLARED)

extern const ob_shape_kind *const ob_shape_kinds[OB_SHAPE_KINDS]; // by ob_shape

// Kind of a shape; one without extent for none and for unknown shapes.
static inline const ob_shape_kind *ob_shape_kind_of(ob_shape shape)
{
	return ob_shape_kinds[(unsigned)shape < OB_SHAPE_KINDS ? shape : OB_SHAPE_NONE];
}

// Returns the shape of this name; OB_SHAPE_NONE: there is none.
ob_shape ob_shape_named(const char *name);
// Half of the largest extent (m) along an axis of its frame.
double ob_shape_longest(ob_shape shape, ob_vec3 size);
// Extent (m) from its centre along the unit vector n of its frame; a hull counts as its bounding ball.
double ob_shape_extent(ob_shape shape, ob_vec3 size, ob_vec3 n);
// Finds the outline. Returns false if it has none.
bool ob_shape_outline(ob_shape shape, ob_vec3 size, ob_outline *out);
// Volume (m^3) and principal moments (kg m^2) of a homogeneous body; 0 for a plane. hull: NULL unless it needs one.
double ob_shape_volume(ob_shape shape, ob_vec3 size, const ob_hull *hull);
ob_vec3 ob_shape_inertia(ob_shape shape, ob_vec3 size, const ob_hull *hull, double mass);

// Corner k of 8 of a box with these half extents: bits of k are the signs.
static inline ob_vec3 ob_box_corner(ob_vec3 half, uint32_t k)
{
	return ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
}

#endif
