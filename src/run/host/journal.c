#include "host/journal.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"

ob_journal_place ob_journal_here(const ob_universe *u)
{
	const ob_script_counts *scripts = ob_universe_step_data(u)->script_counts;
	const uint64_t step = ob_step_count(u);
	return (ob_journal_place){ step, scripts && ob_scripts_ran_for(scripts) == step + 1 };
}

void ob_journal_finish(ob_journal *j)
{
	free(j->entry);
}

bool ob_journal_is_full(const ob_journal *j)
{
	enum { MOST = 1024 }; // some 3 MB
	return j->lost || (j->count >= MOST && j->next == j->count);
}

bool ob_journal_load(ob_journal *j, const ob_journal_entry *entry, size_t count)
{
	if (!count)
		return true;
	j->entry = malloc(count * sizeof *entry);
	if (!j->entry)
		return false;
	memcpy(j->entry, entry, count * sizeof *entry);
	j->count = j->room = count;
	return true;
}

void ob_journal_clear(ob_journal *j)
{
	if (j->next)
		memmove(j->entry, j->entry + j->next, (j->count - j->next) * sizeof *j->entry);
	j->count -= j->next;
	j->next = 0;
	j->lost = false;
}

void ob_journal_rewind(ob_journal *j)
{
	j->next = 0;
}

ob_journal_place ob_journal_next(const ob_journal *j)
{
	return j->next < j->count ? j->entry[j->next].at : (ob_journal_place){ .step = UINT64_MAX };
}

const ob_request *ob_journal_again(ob_journal *j, const ob_journal_place *at)
{
	if (j->next == j->count)
		return NULL;
	const ob_journal_entry *e = &j->entry[j->next];
	if (e->at.step != at->step || e->at.after_scripts != at->after_scripts)
		return NULL;
	j->next++;
	return &e->request;
}

void ob_journal_note(ob_journal *j, const ob_journal_place *at, const ob_request *r)
{
	if (!OB_MAKE_ROOM(j->entry, j->count, j->room)) {
		j->lost = true;
		return;
	}
	j->entry[j->count++] = (ob_journal_entry){ *at, *r };
	j->next = j->count;
}
