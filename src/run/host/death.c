#include "host/death.h"

#include <stdio.h>
#include <string.h>

void ob_death_find_object(ob_death *d, const ob_universe *u)
{
	ob_passport p;
	const bool own = ob_universe_settings(u)->one_per_object && d->worker < ob_universe_simulators(u);
	if (d->worker != OB_NO_WORKER)
		d->object = own ? d->worker : ob_worker_object(u, d->worker);
	if (d->object != OB_NO_OBJECT && ob_universe_get_passport(u, d->object, &p))
		memcpy(d->name, p.name, sizeof d->name);
	else
		d->object = OB_NO_OBJECT;
}

void ob_death_print(const ob_death *d, char *line, size_t size)
{
	const bool named = d->object == OB_NO_OBJECT || d->cause == OB_DEATH_FAILURE || d->object == d->worker;
	int n = snprintf(line, size, "%s", d->text);
	if (!named && n >= 0 && (size_t)n < size)
		n += snprintf(line + n, size - (size_t)n, ", busy with object %u%s%.*s%s", d->object,
			      *d->name ? " (" : "", OB_NAME_MAX, d->name, *d->name ? ")" : "");
	if (*d->words && n >= 0 && (size_t)n < size)
		snprintf(line + n, size - (size_t)n, "; its last words: %s", d->words);
}
