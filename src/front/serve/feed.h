// Stream of a universe for viewers: instead of frames, the existing objects and their motions, from which a viewer
// makes its own frames at any time and from any viewpoint.
//
// A motion is sent when a viewer could not have predicted it (dead reckoning: IEEE 1278.1). For a ballistic body, that
// is each new flight. For a body in contact, whose motion changes in every step, it is a deviation of more than a 256th
// of the object's radius and a quarter of its way in a frame. For a body at rest, it is its final pose.
//
// The messages, little-endian, positions in m, world frame:
//
//      u8  1          u8 flags (1: all earlier messages are void; 2: paused)     u16 0
//      f32 rate (s a s)       f64 time (s, simulated)
//      u32 removed, u32 created, u32 motions; then that number of each:
//        removed      u32 id
//        created      (or created before, with another look from now on)
//                     u32 id, generation; u8 shape; u16 flags (1: static; 2: frozen; 4: it has a mesh, 8: with the
//                     mesh's colours, 16: with the mesh's surface; 32: a sensor; 64: not drawn; 128 times its
//                     ob_pattern); u8 bytes of the name;
//                     u8 surface: roughness, of 15, and 16 times metal, of 15
//                     f32 size[3], inertia[3] (kg m^2), colour[3] (linear RGB);
//                     hulls: u8 corners, u8 faces, u8 parts, u16 number, f32 p[3] of each corner (body's
//                     frame), and of each face u8 corners, then u8 of each, counterclockwise; of a compound
//                     then so many parts, each as a hull;
//                     objects with a mesh: u8 its number, from 1; the name (UTF-8)
//        motion       id less the previous one, in groups of 7 bits, low first, bit 7 on all but the last;
//                     u8 kind, and 4: wide, 8: accelerated, 16: begun; f32 p[3]; i16 q[4] (w x y z, of 32767);
//                     if begun: f32 s before time; if accelerated: f32 a[3]; if it swings: f64 frequency (rad/s);
//                     unless it stands, wide: f32 v[3], w[3], else i16 v[3] (mm/s), w[3] (2 mrad/s)
//
//      u8  2          u8 0    u16 0    u32 contacts    f64 time; then for each:
//                     f32 p[3], n[3], impulse (N s)
//
//      u8  3          u8 number of a mesh, from 1    u8 parts, images    u32 vertices, indices; then that number of:
//        vertices     f32 p[3], n[3], colour[3] (linear RGB; below 0: the object's), surface (15 times the metal,
//                     whole, and then the roughness, below 1; below 0: the object's), place in the images[2]
//        indices      u32 vertex: three a triangle, counterclockwise
//        parts        u32 indices, after those of earlier parts; u8 image of the colours (sRGB), u8 image of
//                     roughness (green) and metal (blue), both from 1 and multiplied with the vertices', 0: none;
//                     u8 wrap[2]: beyond an image's sides it is 0 repeated, 1 mirrored, 2 clamped. No parts: no images
//        images       u32 width, height; then u8 red, green, blue, alpha of each pixel, the top row first
//
//      u8  4          u8 flags (1: a free run's)    u16 0    u32 simulators    f64 time; then for each:
//                     id less the previous one, 1 + home worker (0: unknown), island, substeps, each in groups of 7
//                     bits, low first; u8 state: 0 touches, 1 flies, 2 in equilibrium, 3 asleep; if free,
//                     f32 s, own time less the message's
//
//      u8  5          u8 0    u16 0    u32 joints that hold    f64 time; then for each:
//                     u8 kind (ob_joint_kind); u32 object[2], the second UINT32_MAX: the world; of each object f32 p[3], z[3]:
//                     place and axis of the joint's frame, in the object's (the world's)
//
// One thread at a time.
#ifndef OB_SERVE_FEED_H
#define OB_SERVE_FEED_H

#include <ob/hull.h>
#include <ob/joint.h>

#include "host/pace.h"
#include "host/roster.h"
#include "mesh/mesh.h"
#include "serve/message.h"

enum {
	OB_FEED_MOTIONS = 1,
	OB_FEED_CONTACTS = 2,
	OB_FEED_MESH = 3,
	OB_FEED_SIMULATORS = 4,
	OB_FEED_JOINTS = 5
}; // first byte
enum { OB_FEED_VOID = 1, OB_FEED_PAUSED = 2, OB_FEED_FREE_RUN = 1 }; // flags of motions; of simulators
enum { // an object's
	OB_FEED_STATIC = 1,
	OB_FEED_FROZEN = 2,
	OB_FEED_LOOKS = 4,
	OB_FEED_MESH_COLOUR = 8,
	OB_FEED_MESH_SURFACE = 16,
	OB_FEED_SENSOR = 32,
	OB_FEED_HIDDEN = 64,
	OB_FEED_PATTERN = 128, // times ob_pattern
};

// Continuation of a motion from its instant.
typedef enum ob_feed_kind {
	OB_FEED_STANDS,
	OB_FEED_TURNS, // parabola, and rotation at constant rate
	OB_FEED_FREE, // parabola, and the free rotation of a rigid body
	OB_FEED_SWINGS, // the centre on an ellipse with a frequency, and rotation at constant rate
} ob_feed_kind;

enum { OB_FEED_WIDE = 4, OB_FEED_ACCELERATED = 8, OB_FEED_BEGUN = 16 }; // with the kind

typedef struct ob_feed ob_feed;

// Source of a feed. Each function gets "of".
typedef struct ob_feed_source {
	const void *of;
	uint64_t (*number)(const void *of); // as ob_roster_number
	size_t (*list)(const void *of, ob_roster_entry *out, size_t max); // as ob_roster_copy
	bool (*passport)(const void *of, uint32_t id, ob_passport *out); // as ob_universe_get_passport
	uint64_t (*passport_version)(const void *of, uint32_t id); // changes with the object's look
	bool (*motion)(const void *of, uint32_t id, ob_motion *out); // as ob_universe_get_motion
	bool (*hull)(const void *of, uint32_t hull, ob_hull *out); // as ob_universe_get_hull
	uint32_t (*joints)(const void *of); // as ob_universe_joints
	bool (*joint)(const void *of, uint32_t joint, ob_joint_passport *out); // as ob_universe_get_joint
	double (*time)(const void *of); // s, simulated
	double step_length; // s
	double unseen; // s: an object may deviate by its motion in this time, too, for that is invisible while it moves
} ob_feed_source;

// Feed of a running universe and its roster, which must outlive it. NULL: out of memory.
ob_feed *ob_feed_create(const ob_universe *u, const ob_roster *r);
// Feed of another source, without contacts.
ob_feed *ob_feed_create_of(const ob_feed_source *source);
void ob_feed_destroy(ob_feed *f); // NULL is allowed

// Changes since the last call; NULL: none, not even the time; or out of memory.
ob_message *ob_feed_next(ob_feed *f, const ob_pace_state *pace);
// The whole state so far, for a new viewer. NULL: out of memory.
ob_message *ob_feed_whole(ob_feed *f, const ob_pace_state *pace);
// Takes the id of an object that viewers were sent as frozen, each once. at: 0 at the first of several calls. false:
// none is left.
bool ob_feed_take_frozen(ob_feed *f, size_t *at, uint32_t *id);
// All contact points. NULL: out of memory.
ob_message *ob_feed_contacts(ob_feed *f);
// Simulators of all objects, as of the last message of ob_feed_next. NULL: out of memory.
ob_message *ob_feed_simulators(ob_feed *f);
// All joints that hold. NULL: out of memory.
ob_message *ob_feed_joints(ob_feed *f);
// A mesh of the scene: content, which never changes. NULL: out of memory.
ob_message *ob_feed_mesh(const ob_mesh *m, uint32_t number);

#endif
