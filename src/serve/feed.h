// What is told to viewers of a universe: not frames, but what exists and how it moves, from which a viewer makes frames
// of its own at any time and from any place.
//
// A motion is told when a viewer could not have foretold it (dead reckoning: IEEE 1278.1). Of what flies, that is a new
// flight; of what touches others, whose motion changes in every step, when what was told is off by more than a 256th of
// the object's radius and a quarter of its way in a frame; of what comes to rest, that it stands, and where.
//
// The messages, little-endian, positions in m, world frame:
//
//      u8  1          u8 flags (1: all that was told before is void; 2: paused)     u16 0
//      f32 rate (s a s)       f64 time (s, simulated)
//      u32 removed, u32 created, u32 motions; then so many of each:
//        removed      u32 id
//        created      (or one that was created before, and looks otherwise from now on)
//                     u32 id, generation; u8 shape; u8 flags (1: static; 2: frozen; 4: it looks like a mesh,
//                     8: whose colours are shown, 16: whose surface is); u8 bytes of the name;
//                     u8 surface: roughness, of 15, and 16 times metal, of 15
//                     f32 size[3], inertia[3] (kg m^2), colour[3] (linear RGB);
//                     of a hull: u8 corners, u8 faces, u16 number, f32 p[3] of each corner (body's frame), and of each
//                     face u8 corners, then u8 of each, counterclockwise;
//                     of what looks like a mesh: u8 its number, from 1; the name (UTF-8)
//        motion       id less the one before, in groups of 7 bits, low first, bit 7 on all but the last;
//                     u8 kind, and 4: wide, 8: accelerated, 16: begun; f32 p[3]; i16 q[4] (w x y z, of 32767);
//                     if begun: f32 s before time; if accelerated: f32 a[3]; if it swings: f64 frequency (rad/s);
//                     unless it stands, wide: f32 v[3], w[3], else i16 v[3] (mm/s), w[3] (2 mrad/s)
//
//      u8  2          u8 0    u16 0    u32 contacts    f64 time; then so many:
//                     f32 p[3], n[3], impulse (N s)
//
//      u8  3          u8 number of a mesh, from 1    u8 parts, images    u32 vertices, indices; then so many:
//        vertices     f32 p[3], n[3], colour[3] (linear RGB; below 0: the object's), surface (15 times the metal,
//                     whole, and then the roughness, below 1; below 0: the object's), place in the images[2]
//        indices      u32 vertex: three a triangle, counterclockwise
//        parts        u32 indices, after those of the parts before; u8 image of the colours (sRGB), u8 image of
//                     roughness (green) and metal (blue), both from 1 and multiplied with the vertices', 0: none;
//                     u8 wrap[2]: along an image's sides it is 0 repeated, 1 mirrored, 2 held. No parts: no images
//        images       u32 width, height; then u8 red, green, blue, alpha of each pixel, the top row first
//
// One thread's.
#ifndef OB_SERVE_FEED_H
#define OB_SERVE_FEED_H

#include <ob/hull.h>

#include "host/pace.h"
#include "host/roster.h"
#include "mesh/mesh.h"
#include "serve/message.h"

enum { OB_FEED_MOTIONS = 1, OB_FEED_CONTACTS = 2, OB_FEED_MESH = 3 }; // first byte of a message
enum { OB_FEED_VOID = 1, OB_FEED_PAUSED = 2 }; // its flags
enum { // an object's
	OB_FEED_STATIC = 1,
	OB_FEED_FROZEN = 2,
	OB_FEED_LOOKS = 4,
	OB_FEED_MESH_COLOUR = 8,
	OB_FEED_MESH_SURFACE = 16,
};

// How a motion goes on from its instant.
typedef enum ob_feed_kind {
	OB_FEED_STANDS,
	OB_FEED_TURNS, // parabola, and a turn at constant rate
	OB_FEED_FREE, // parabola, and the free rotation of a rigid body
	OB_FEED_SWINGS, // an ellipse about which the centre goes with a frequency, and a turn at constant rate
} ob_feed_kind;

enum { OB_FEED_WIDE = 4, OB_FEED_ACCELERATED = 8, OB_FEED_BEGUN = 16 }; // with the kind

typedef struct ob_feed ob_feed;

// Where a feed looks. What each function is given is "of".
typedef struct ob_feed_source {
	const void *of;
	uint64_t (*number)(const void *of); // as ob_roster_number
	size_t (*list)(const void *of, ob_roster_entry *out, size_t max); // as ob_roster_copy
	bool (*passport)(const void *of, uint32_t id, ob_passport *out); // as ob_universe_get_passport
	uint64_t (*passport_version)(const void *of, uint32_t id); // another one after it has come to look otherwise
	bool (*motion)(const void *of, uint32_t id, ob_motion *out); // as ob_universe_get_motion
	bool (*hull)(const void *of, uint32_t hull, ob_hull *out); // as ob_universe_get_hull
	double (*time)(const void *of); // s, simulated
	double step_length; // s
	double unseen; // s: what an object may be off by is its way in so long, too, for nobody sees it stand still
} ob_feed_source;

// Of a running universe and its roster, which must outlive it. NULL: out of memory.
ob_feed *ob_feed_create(const ob_universe *u, const ob_roster *r);
// Of anything else; it has no contacts.
ob_feed *ob_feed_create_of(const ob_feed_source *source);
void ob_feed_destroy(ob_feed *f); // NULL is allowed

// What is new since the last call; NULL: nothing is, not even the time; or out of memory.
ob_message *ob_feed_next(ob_feed *f, const ob_pace_state *pace);
// All that was told so far, for who comes later. NULL: out of memory.
ob_message *ob_feed_whole(ob_feed *f, const ob_pace_state *pace);
// Where objects touch. NULL: out of memory.
ob_message *ob_feed_contacts(ob_feed *f);
// A mesh of the scene: content, which never changes. NULL: out of memory.
ob_message *ob_feed_mesh(const ob_mesh *m, uint32_t number);

#endif
