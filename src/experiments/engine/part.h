// A part of obsim that calls another engine's library (base/part.h): obsim-bullet.so, obsim-mujoco.so. The functions are
// those of ob_engine_kind; parts.c describes the engines to the program.
#ifndef OB_ENGINE_PART_H
#define OB_ENGINE_PART_H

#include "base/part.h"
#include "engine/engine.h"

typedef struct ob_engine_part {
	ob_part_head head;
	// variant: 0: the usual one
	ob_engine *(*create)(const ob_world *w, const ob_run_settings *s, uint32_t variant, ob_error *e);
	bool (*step)(ob_engine *p, ob_error *e);
	void (*get)(const ob_engine *p, ob_state *state);
	void (*destroy)(ob_engine *p);
} ob_engine_part;

#endif
