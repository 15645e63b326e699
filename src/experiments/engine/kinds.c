#include <string.h>

#include "engine/engines.h"

const ob_engine_kind *const ob_engine_kinds[] = {
	&ob_engine_obsim,
	&ob_engine_obsim_jacobi,
	&ob_engine_obsim_ode,
	&ob_engine_obsim_ghost,
	&ob_engine_obsim_lag,
	&ob_engine_free_ledger,
	&ob_engine_free_ledger_processes,
	&ob_engine_free_own,
	&ob_engine_free_own_processes,
	&ob_engine_free_heavy,
	&ob_engine_free_ode,
	&ob_engine_ode_quick,
	&ob_engine_ode_advised,
	&ob_engine_ode_world,
#ifdef OB_BULLET_VERSION
	&ob_engine_bullet,
#endif
#ifdef OB_MUJOCO_VERSION
	&ob_engine_mujoco,
	&ob_engine_mujoco_rk4,
#endif
	NULL,
};

const ob_engine_kind *ob_engine_find(const char *name)
{
	for (const ob_engine_kind *const *k = ob_engine_kinds; *k; k++)
		if (strcmp((*k)->name, name) == 0)
			return *k;
	return NULL;
}
