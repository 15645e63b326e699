// Viewer: a thread that draws the newest snapshot again and again, as fast as it can.
#ifndef OB_PAPER_VIEWER_H
#define OB_PAPER_VIEWER_H

#include "render/render.h"

enum { OB_PAPER_WIDTH = 640, OB_PAPER_HEIGHT = 480 };

typedef struct ob_viewer ob_viewer;

// Returns once the first frame is drawn, which takes longer than others. The scene must outlive it. Returns NULL and e
// if drawing is impossible here. Call it after the host has started, which forks.
ob_viewer *ob_viewer_open(const ob_scene *scene, const ob_snapshot *first, ob_error *e);
// Sets the snapshot to draw from now on; copies it. Returns false if memory runs out. One thread.
bool ob_viewer_show(ob_viewer *v, const ob_snapshot *now);
uint64_t ob_viewer_frames(ob_viewer *v); // drawn so far
// Frees v. Returns false and e if drawing has failed in between.
bool ob_viewer_close(ob_viewer *v, ob_error *e);

#endif
