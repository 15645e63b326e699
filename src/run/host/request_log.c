#include "host/request_log.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/file.h"
#include "scene/object_limits.h"

#define BYTES_MAX ((uint64_t)960 << 20) // of a log that is read

static const char magic[8] = { 'O', 'B', 'S', 'I', 'M', 'R', 'Q', '1' };

typedef enum record_kind { A_REQUEST, A_FREEZE, A_STATE } record_kind;

typedef struct record {
	uint32_t kind, id, generation, zero;
	uint64_t hash;
	ob_journal_entry entry; // a freeze uses its place alone, a state its step
} record;

typedef struct file_head {
	char magic[8];
	uint64_t record_size; // in this program
	ob_request_log_head head;
} file_head;

struct ob_request_log {
	FILE *file;
	const char *path;
	bool failed;
};

// ---- written

static void append(ob_request_log *l, const void *bytes, size_t n)
{
	l->failed |= fwrite(bytes, 1, n, l->file) != n;
}

ob_request_log *ob_request_log_create(const char *path, const ob_request_log_head *head, ob_error *e)
{
	ob_request_log *l = calloc(1, sizeof *l);
	file_head h = { .record_size = sizeof(record), .head = *head };
	memcpy(h.magic, magic, sizeof magic);
	h.head.run.fault = (ob_fault_plan){ 0 };
	if (l)
		l->file = fopen(path, "wbe");
	if (!l || !l->file) {
		free(l);
		ob_fail(e, "%s: %s", path, strerror(errno));
		return NULL;
	}
	l->path = path;
	append(l, &h, sizeof h);
	return l;
}

void ob_request_log_request(ob_request_log *l, const ob_journal_place *at, const ob_request *r)
{
	if (!l)
		return;
	const record x = { .kind = A_REQUEST, .entry = { *at, *r } };
	append(l, &x, sizeof x);
}

void ob_request_log_freeze(ob_request_log *l, const ob_freeze *f)
{
	if (!l)
		return;
	const record x = { .kind = A_FREEZE, .id = f->id, .generation = f->generation, .entry.at = f->at };
	append(l, &x, sizeof x);
}

void ob_request_log_state(ob_request_log *l, uint64_t step, uint64_t hash)
{
	if (!l)
		return;
	const record x = { .kind = A_STATE, .hash = hash, .entry.at.step = step };
	append(l, &x, sizeof x);
	ob_request_log_flush(l);
}

void ob_request_log_flush(ob_request_log *l)
{
	if (l)
		l->failed |= fflush(l->file) != 0;
}

bool ob_request_log_close(ob_request_log *l, ob_error *e)
{
	if (!l)
		return true;
	bool fine = fclose(l->file) == 0 && !l->failed;
	if (!fine)
		ob_fail(e, "%s: the log of requests is not whole: %s", l->path, strerror(errno));
	free(l);
	return fine;
}

// ---- read

static bool makes_sense(const ob_request *r)
{
	ob_error e;
	if (r->kind >= OB_REQUEST_AT_ONCE || r->bytes > sizeof r->values)
		return false;
	return r->kind != OB_REQUEST_ADD || (!r->def.path && !r->def.force && !r->def.script && !r->def.state_bytes &&
					     r->corners.count <= OB_HULL_CORNERS_MAX && ob_object_check(&r->def, &e));
}

// false: an invalid record, or no memory
static bool take(ob_logged_requests *l, const record *x)
{
	const uint64_t step = x->entry.at.step;
	while (x->kind != A_STATE && l->states && l->state[l->states - 1].step == step)
		l->states--; // a replay carries out all requests at this step before it compares
	switch (x->kind) {
	case A_REQUEST:
		if (!makes_sense(&x->entry.request) || !OB_GROW(l->request, (size_t)l->requests + 1))
			return false;
		l->request[l->requests++] = x->entry;
		return true;
	case A_FREEZE:
		if (!OB_GROW(l->freeze, (size_t)l->freezes + 1))
			return false;
		l->freeze[l->freezes++] = (ob_freeze){ x->entry.at, x->id, x->generation };
		return true;
	case A_STATE:
		if (!OB_GROW(l->state, (size_t)l->states + 1))
			return false;
		l->state[l->states++] = (ob_logged_state){ step, x->hash };
		return true;
	default:
		return false;
	}
}

static bool read_records(ob_logged_requests *l, FILE *f, const char *path, ob_error *e)
{
	file_head h;
	record x;
	uint64_t last = 0;
	if (fread(&h, sizeof h, 1, f) != 1 || memcmp(h.magic, magic, sizeof magic) != 0 || h.record_size != sizeof x)
		return ob_fail(e, "%s: it is no log of requests of this version of obsim", path);
	l->head = h.head;
	for (uint32_t n = 0; fread(&x, sizeof x, 1, f) == 1; n++) {
		if (x.entry.at.step < last || !take(l, &x))
			return ob_fail(e, "%s: record %u makes no sense", path, n);
		last = x.entry.at.step;
	}
	return true;
}

bool ob_request_log_read(ob_logged_requests *out, const char *path, ob_error *e)
{
	*out = (ob_logged_requests){ 0 };
	uint64_t bytes;
	ob_error why;
	const int fd = ob_file_open(path, BYTES_MAX, &bytes, &why);
	if (fd < 0)
		return ob_fail(e, "%s: %s", path, why.text);
	FILE *f = fdopen(fd, "rb");
	if (!f) {
		close(fd);
		return ob_fail(e, "%s: %s", path, strerror(errno));
	}
	const bool fine = read_records(out, f, path, e);
	fclose(f);
	return fine;
}

void ob_logged_requests_finish(ob_logged_requests *l)
{
	free(l->request);
	free(l->freeze);
	free(l->state);
}

// ---- journal

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
