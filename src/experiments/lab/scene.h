// Cases that are scenes: what a file says by expect and case becomes a case of the lab, and its objects a world for every
// engine.
#ifndef OB_LAB_SCENE_H
#define OB_LAB_SCENE_H

#include "lab/case.h"
#include "scene/expect.h"

// Text of a case; one that has no file is a part of the program.
struct ob_case_text {
	char *path, *text;
	size_t size;
	const char *variant; // -D variant=; NULL: the scene has none
};

// Reads all variants of a scene and hands each to "add" as a new case, which lasts as long as the program. text: NULL to read
// the file. false and e: the scene is wrong, expects nothing, or has something that the engines of the lab lack; or add failed.
bool ob_lab_scene_read(const char *path, const char *text, bool (*add)(const ob_case *c, ob_error *e), ob_error *e);

// Scene of a run of the case, with its world; finish both. NULL and e: no memory, or as above.
ob_scene *ob_lab_scene_load(const ob_case *c, uint32_t run, ob_world *w, ob_error *e);

// A world's snapshot: its objects are those of the world, which must last, and as they were when it was last taken (time in s); it
// points to state.
// Its end must be called even if begin failed (false: no memory).
bool ob_lab_snapshot_begin(ob_snapshot *now, const ob_world *w);
void ob_lab_snapshot_take(ob_snapshot *now, double time, ob_state *state);
void ob_lab_snapshot_end(ob_snapshot *now);

#endif
