// The trace records the activities of each worker, as spans in a ring of its own in the universe. The host writes them
// to a file while the run goes on. Only with ob_universe_setup.traced; an event then costs some 10 ns and the reading
// of a clock.
//
//        worker 0         worker 1              host            supervisor
//      +----------+     +----------+        +----------+       +----------+
//      | ring     |     | ring     |   ...  | ring     |       | ring     |    one writer each
//      +----+-----+     +----+-----+        +----+-----+       +----+-----+
//           +----------------+---- ob_trace_take ----+------------------+       one reader of all
//
// A ring: event[n % size], written = events that are complete, taken = those that the reader has. The writer fills an
// event and then stores "written" (release); the reader copies events and then stores "taken" (release). Neither
// waits. An event that finds the ring full is counted in "lost". A writer that is killed leaves all complete events
// readable, and in "doing" the span that it had begun.
#ifndef OB_TABLE_TRACE_H
#define OB_TABLE_TRACE_H

#include <ob/universe.h>

// Times are from ob_clock_ns. Kinds of lower level enclose those of higher level on the same track.
typedef enum ob_trace_kind {
	OB_TRACE_NONE,
	OB_TRACE_WAIT, // at the gate
	OB_TRACE_SOLVE, // phase ISLANDS; a = islands, b = their bodies
	OB_TRACE_OBJECTS, // phases of neighbours, pairs and copies
	OB_TRACE_SCHEDULE, // the scheduler, between phases
	OB_TRACE_CHUNK, // islands claimed at once; a, b as above
	OB_TRACE_ISLAND, // a = lowest id, b = bodies
	OB_TRACE_PROFILE, // a = ob_profile_section
	OB_TRACE_STEPS, // of a free run's simulators; a = their number
	OB_TRACE_CLOCK, // a free run's worker waits until a step is due
	OB_TRACE_LAG, // the bound of the lag: the simulator of object a waits for that of object b
	OB_TRACE_STATE, // object a has been in a state until now; b = ob_trace_state before | state after << 8
	OB_TRACE_BIRTH, // of object a
	OB_TRACE_DEATH, // of object a
	OB_TRACE_KILLED, // worker a ended before STOP; b = its signal, 0 = it exited
	OB_TRACE_SNAPSHOT, // the host copies all motions
	OB_TRACE_MEASURE, // energy, momentum, penetration
	OB_TRACE_RECORD, // writing to HDF5
	OB_TRACE_DRAW, // frame a
	OB_TRACE_ENCODE, // queueing frame a for encoding
	OB_TRACE_KINDS
} ob_trace_kind;

typedef enum ob_trace_motion {
	OB_TRACE_ABSENT,
	OB_TRACE_FLYING,
	OB_TRACE_TOUCHING,
	OB_TRACE_ASLEEP,
	OB_TRACE_MOTIONS
} ob_trace_motion;

typedef struct ob_trace_event {
	uint64_t begin, end; // ns
	uint32_t kind; // ob_trace_kind
	uint32_t a, b; // by kind
	uint32_t step; // step being computed
} ob_trace_event;

bool ob_universe_traced(const ob_universe *u);

// Rings 0 .. workers-1 belong to the workers; then come one of the host's main thread and one of its supervisor.
uint32_t ob_trace_rings(const ob_universe *u);
uint32_t ob_trace_host(const ob_universe *u);
uint32_t ob_trace_supervisor(const ob_universe *u);

// For writers, each on its own ring, and only if the universe is traced. Writes a span from begin until now; its step
// is the one after the complete ones. Returns now.
uint64_t ob_trace_span(ob_universe *u, uint32_t ring, ob_trace_kind kind, uint64_t begin, uint32_t a, uint32_t b);
// Records the writer's current span, in case it dies before it can write it. NONE = nothing. Writing a span does not
// change it.
void ob_trace_doing(ob_universe *u, uint32_t ring, ob_trace_kind kind, uint64_t begin);
// Called by the worker that publishes the motion of object id, with the flags (OB_MOTION_*) of the motion before and of
// this one: one event if the object's state, as an ob_trace_motion, has changed.
void ob_trace_moves(ob_universe *u, uint32_t ring, uint32_t id, uint32_t flags_before, uint32_t flags);
// Called by the host while the universe stands still: object id is added or removed; its passport is in the table.
void ob_trace_birth(ob_universe *u, uint32_t id);
void ob_trace_death(ob_universe *u, uint32_t id, uint32_t flags_before);

// For the reader. Copies its oldest new events, at most max; returns their number.
uint32_t ob_trace_take(ob_universe *u, uint32_t ring, ob_trace_event *out, uint32_t max);
uint64_t ob_trace_lost(const ob_universe *u, uint32_t ring);
// Unfinished span of the ring's writer; kind NONE: nothing.
ob_trace_event ob_trace_unfinished(const ob_universe *u, uint32_t ring);
// Time (ns) of the last change of state of object id.
uint64_t ob_trace_since(const ob_universe *u, uint32_t id);
ob_trace_motion ob_trace_motion_of(uint32_t flags);
// Name of object id, or of the last object that had this id; returns false if there has been none.
bool ob_trace_name(const ob_universe *u, uint32_t id, char name[OB_NAME_MAX]);

#endif
