// Inside the module peer only: Bullet, whose C++ stays behind these functions (as in ob_peer_kind).
#ifndef OB_PEER_BULLET_H
#define OB_PEER_BULLET_H

#include "peer/peer.h"

// w's passports must hold shapes; s->substeps and s->iterations are at least 1.
ob_peer *ob_bullet_create(const ob_peer_world *w, const ob_peer_settings *s, ob_error *e);
bool ob_bullet_step(ob_peer *p, ob_error *e);
void ob_bullet_get(const ob_peer *p, ob_state *state);
void ob_bullet_destroy(ob_peer *p);

#endif
