// Inside the module peer only: the engines that kinds.c lists. Each file that makes them has its own struct ob_peer.
#ifndef OB_PEER_ENGINES_H
#define OB_PEER_ENGINES_H

#include "peer/peer.h"

extern const ob_peer_kind ob_peer_obsim; // obsim.c: one engine for each way to exchange, and one with ODE's stepper
extern const ob_peer_kind ob_peer_obsim_jacobi;
extern const ob_peer_kind ob_peer_obsim_ode;
extern const ob_peer_kind ob_peer_obsim_ghost;
extern const ob_peer_kind ob_peer_obsim_lag;
extern const ob_peer_kind ob_peer_ode_quick; // ode.c
extern const ob_peer_kind ob_peer_ode_world;
extern const ob_peer_kind ob_peer_bullet; // bullet.c

// What ODE keeps for a thread lives as long as any peer of that thread needs it.
void ob_peer_ode_enter(void);
void ob_peer_ode_leave(void);

#endif
