// Random lives: a small scene, as Lua, and what comes to it from outside while it runs, step by step.
//
// A life follows from its seed alone; objects and events can be left out of it, one by one, to shrink it.
//
//   bit        0 ..             LIFE_OBJECTS ..     LIFE_OBJECTS + LIFE_THINGS ..   62                       63
//   objects    plain bodies     things (things.h)   bodies with FMUs                a reader all the while   failing islands are frozen
//   events     of a stranger    deeds of visitors (deeds.h) from LIFE_EVENTS on
#ifndef OB_TESTS_LIVES_LIFE_H
#define OB_TESTS_LIVES_LIFE_H

#include <stdbool.h>
#include <stdint.h>

enum {
	LIFE_STEPS = 300,
	LIFE_OBJECTS = 12,
	LIFE_THINGS = 12,
	LIFE_FMUS = 4,
	LIFE_EVENTS = 40,
	LIFE_DEEDS = 24,
	LIFE_READER = 62,
	LIFE_KEEPS,
	LIFE_PARTS,
	LIFE_TEXT = 65536
};

typedef enum life_event_kind {
	LIFE_CREATE,
	LIFE_REMOVE,
	LIFE_CREATE_REMOVE, // one object, in one pause
	LIFE_REPLACE, // removes one and creates another, in one pause
	LIFE_MESSAGE,
	LIFE_COLOUR,
	LIFE_FREEZE,
	LIFE_PAUSE, // the run stands still once more, at the same step
	LIFE_KILL, // a simulator, while the run stands or soon after
	LIFE_RESUME, // the run is put down, and taken up again
	LIFE_EVENT_KINDS,
	LIFE_VISIT = LIFE_EVENT_KINDS, // likewise below: deeds of visitors. A command of any kind
	LIFE_CREATE_ANY, // a body of any shape, and a joint, written as in a scene
	LIFE_AVATAR,
	LIFE_LEAVE, // lets go, and its avatar is removed
	LIFE_RETURN, // a snapshot is kept; some steps later the run goes back to it
	LIFE_MOVE, // a simulator goes to another worker
	LIFE_ALL_KINDS
} life_event_kind;

typedef struct life_event {
	uint32_t step, kind;
	uint64_t seed; // draws the rest
} life_event;

// Objects and events that are left; bits.
typedef struct life_parts {
	uint64_t objects, events;
} life_parts;

typedef struct life {
	uint64_t seed;
	bool scripts, reader, keeps;
	bool closed; // of a free run: nothing acts from outside, so momentum stays
	char text[LIFE_TEXT]; // the scene's
	uint32_t objects, events; // before any is left out; events: left
	life_event event[LIFE_EVENTS + LIFE_DEEDS]; // by step
} life;

// free: as a free run takes it.
void life_make(life *l, uint64_t seed, life_parts left, bool free);

#endif
