// Bullet behind C functions (as in ob_engine_kind). Internal to the module.
#ifndef OB_ENGINE_BULLET_H
#define OB_ENGINE_BULLET_H

#include "engine/engine.h"

// w's body properties must have shapes; s->substeps and s->iterations are at least 1.
ob_engine *ob_bullet_create(const ob_world *w, const ob_run_settings *s, ob_error *e);
bool ob_bullet_step(ob_engine *p, ob_error *e);
void ob_bullet_get(const ob_engine *p, ob_state *state);
void ob_bullet_destroy(ob_engine *p);

#endif
