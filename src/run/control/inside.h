// The part of obsim that runs a universe within a program: obsim-inside.so (base/part.h), which libobsim loads.
//
//   program ──> libobsim: ob_controller_* ──packet──> obsim-inside.so: the host, and its only worker
//           <── libobsim: ob_universe_*   <──────────  the universe, in shared memory as any other
//
// Thread-safety: one thread at a time for each run.
#ifndef OB_CONTROL_INSIDE_H
#define OB_CONTROL_INSIDE_H

#include "base/part.h"
#include "control/packet.h"

typedef struct ob_inside_run ob_inside_run;

typedef struct ob_inside_part {
	ob_part_head head;
	// words: a scene and options, as of obsim control. Writes the name of its universe. NULL and e: it cannot be run.
	ob_inside_run *(*open)(const char *const *words, size_t n, char name[OB_NAME_MAX], ob_error *e);
	// Carries out a command; the answer holds until the next one.
	const ob_control_answer *(*call)(ob_inside_run *r, const ob_control_packet *p, size_t bytes);
	void (*close)(ob_inside_run *r);
} ob_inside_part;

#endif
