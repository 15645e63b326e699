#include "base/random.h"
#include "settings/settings.h"

ob_fault_kind ob_fault_draw(const ob_fault_plan *p, uint32_t among, uint32_t worker, uint64_t chance, uint64_t *random)
{
	const uint32_t kinds = p->kinds & among;
	uint64_t state = p->seed;
	state = ob_splitmix(&state) + worker;
	state = ob_splitmix(&state) + chance;
	if (!kinds || ob_splitmix_real(&state) >= p->probability)
		return OB_FAULT_KINDS;
	uint32_t nth = (uint32_t)(ob_splitmix(&state) % (uint32_t)__builtin_popcount(kinds)), kind = 0;
	while (!(kinds >> kind & 1) || nth-- > 0)
		kind++;
	*random = state;
	return (ob_fault_kind)kind;
}
