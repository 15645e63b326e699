#include <string.h>

#include "peer/engines.h"

const ob_peer_kind *const ob_peer_kinds[] = {
	&ob_peer_obsim,
	&ob_peer_obsim_jacobi,
	&ob_peer_obsim_ode,
	&ob_peer_obsim_ghost,
	&ob_peer_obsim_lag,
	&ob_peer_ode_quick,
	&ob_peer_ode_world,
#ifdef OB_HAVE_BULLET
	&ob_peer_bullet,
#endif
	NULL,
};

const ob_peer_kind *ob_peer_find(const char *name)
{
	for (const ob_peer_kind *const *k = ob_peer_kinds; *k; k++)
		if (strcmp((*k)->name, name) == 0)
			return *k;
	return NULL;
}
