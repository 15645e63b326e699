#include "free/schedule.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/budget.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/log.h"

static const uint64_t most_bytes = UINT64_C(128) << 20;
static const char misfit[] = "it does not fit the scene: steps are missing, or in another order";

typedef struct file_head {
	char mark[8];
	uint64_t format;
	uint64_t hash; // checksum of all after it
	uint64_t digest;
	ob_free_settings settings;
} file_head;

typedef struct step_head {
	uint32_t mark, words; // words: numbers after the head: object and version of each read, then neighbours
	uint64_t hash; // checksum of all after it
	uint64_t version;
	double end;
	uint32_t id, reads, listed, anew; // listed: 1 + number of neighbours; 0 = it did not look
} step_head;

static const char file_mark[8] = "obsched";
enum { FORMAT = 3, STEP_MARK = 0x70657473, LOST_MARK = 0x74736f6c, END_MARK = 0x2e646e65 };

// A version that steps to come will read.
typedef struct kept {
	struct kept *next;
	uint64_t version;
	uint32_t readers;
	ob_motion motion;
} kept;

// Versions that steps read, ascending: id << 32 | number.
typedef struct versions {
	uint64_t *name; // [n]
	uint32_t *readers; // [n] in steps to come
	size_t n;
} versions;

struct ob_free_schedule {
	int fd; // recording; -1: a replay
	const char *wrong; // error; NULL: none
	step_head step; // recorded now, or the next one of a replay
	uint32_t *read, reads_max; // recording: pairs
	uint32_t *neighbour, neighbours, neighbours_max;
	// replay
	char *bytes;
	size_t size, at; // at: of the next step
	uint32_t taken; // reads of it so far
	uint32_t objects;
	versions wanted;
	kept **kept; // [objects]
	size_t kept_bytes;
};

static bool says_why(const char *path, ob_error *e)
{
	return ob_fail(e, "%s: %s", path, strerror(errno));
}

// ---- the program

static uint64_t hash_of_head(const file_head *h)
{
	const size_t from = offsetof(file_head, digest);
	return ob_hash_on(OB_HASH_BEGIN, (const char *)h + from, sizeof *h - from);
}

bool ob_free_schedule_create(const char *path, const ob_free_settings *f, uint64_t digest, ob_error *e)
{
	file_head head = { .format = FORMAT, .digest = digest, .settings = *f };
	memset(head.settings.schedule, 0, sizeof head.settings.schedule);
	memcpy(head.mark, file_mark, sizeof head.mark);
	head.hash = hash_of_head(&head);
	const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (fd < 0)
		return says_why(path, e);
	const bool fine = write(fd, &head, sizeof head) == sizeof head;
	return (close(fd) == 0 && fine) || says_why(path, e);
}

static uint64_t hash_of(const step_head *h, const uint32_t *word)
{
	const size_t from = offsetof(step_head, version);
	const uint64_t hash = ob_hash_on(OB_HASH_BEGIN, (const char *)h + from, sizeof *h - from);
	return ob_hash_on(hash, word, h->words * sizeof *word);
}

bool ob_free_schedule_end(const char *path, ob_error *e)
{
	struct stat file;
	const int fd = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
	if (fd < 0 || fstat(fd, &file) != 0)
		return says_why(path, e);
	step_head end = { .mark = END_MARK, .version = (uint64_t)file.st_size };
	end.hash = hash_of(&end, NULL);
	if (end.version + sizeof end > most_bytes)
		ob_log_warn("%s cannot be replayed: it is larger than %" PRIu64 " MiB", path, most_bytes >> 20);
	const bool fine = write(fd, &end, sizeof end) == sizeof end;
	return (close(fd) == 0 && fine) || says_why(path, e);
}

// Copies the head of the step at a place. NULL: it is whole; else what is wrong.
static const char *read_step(const char *bytes, size_t size, size_t at, step_head *out)
{
	if (size - at < sizeof *out)
		return "it is cut off, or its run did not come to its end";
	memcpy(out, bytes + at, sizeof *out);
	if (out->mark != STEP_MARK && out->mark != END_MARK)
		return "there is no step";
	if (out->words > (size - at - sizeof *out) / sizeof(uint32_t))
		return "the step is longer than the file";
	if (hash_of(out, (const uint32_t *)(bytes + at + sizeof *out)) != out->hash)
		return "the step does not bear its checksum";
	if (out->mark == STEP_MARK &&
	    (2 * (uint64_t)out->reads + (out->listed ? out->listed - 1 : 0) != out->words || !isfinite(out->end)))
		return "the step makes no sense";
	return NULL;
}

static size_t after(const step_head *h, size_t at)
{
	return at + sizeof *h + h->words * sizeof(uint32_t);
}

// Checks all steps from the first on.
static bool check_steps(const char *bytes, size_t size, uint32_t objects, ob_error *e)
{
	step_head h = { 0 };
	size_t at = sizeof(file_head);
	for (; h.mark != END_MARK; at = after(&h, at)) {
		const char *wrong = read_step(bytes, size, at, &h);
		if (!wrong && h.mark == END_MARK && (h.version != at || after(&h, at) != size))
			wrong = "steps are missing, or something follows the end";
		if (!wrong && h.mark == STEP_MARK && h.id >= objects)
			wrong = "the step is of an object that does not exist";
		if (wrong)
			return ob_fail(e, "damaged at byte %zu: %s", at, wrong);
	}
	return true;
}

static const char *check_head(const file_head *h, size_t size, uint64_t digest)
{
	if (size < sizeof *h || memcmp(h->mark, file_mark, sizeof h->mark) != 0)
		return "it is no schedule of a free run (obsim run --set record_schedule)";
	if (h->format != FORMAT)
		return "it was written by another version of obsim";
	if (h->hash != hash_of_head(h))
		return "damaged at byte 0: the head does not bear its checksum";
	if (h->digest != digest)
		return "it was recorded with another scene, -D, --seed or option of the solver";
	const ob_free_settings *f = &h->settings;
	const ob_setting *t = ob_setting_table;
	if (!(f->update_rate > 0 && f->update_rate <= OB_UPDATE_RATE_MOST && f->max_lag >= 0 && f->jitter >= 0 &&
	      f->jitter <= t[OB_SETTING_JITTER].most && f->delay >= 0 && f->delay <= t[OB_SETTING_DELAY].most &&
	      f->pace > 0 && f->coupling == OB_COUPLING_OWN && f->heavy <= 1))
		return "damaged at byte 0: the settings are out of range";
	return NULL;
}

bool ob_free_schedule_check(const char *path, uint64_t digest, ob_free_settings *f, ob_error *e)
{
	ob_error why;
	size_t size;
	char *bytes = ob_file_load(path, most_bytes, &size, &why);
	if (!bytes)
		return ob_fail(e, "%s: %s", path, why.text);
	const file_head *h = (const file_head *)bytes;
	const char *wrong = check_head(h, size, digest);
	bool fine = !wrong || ob_fail(&why, "%s", wrong);
	fine = fine && check_steps(bytes, size, UINT32_MAX, &why);
	if (fine)
		*f = h->settings;
	free(bytes);
	return fine || ob_fail(e, "%s: %s", path, why.text);
}

// ---- a worker

static const uint32_t *words_at(const ob_free_schedule *s, size_t at)
{
	return (const uint32_t *)(s->bytes + at + sizeof(step_head));
}

// Marks steps that were recorded, but not published before their simulator was killed.
static bool mark_lost(ob_free_schedule *s)
{
	size_t *last = calloc(s->objects + 1, sizeof *last);
	step_head h = { 0 }, before;
	for (size_t at = s->at; last && h.mark != END_MARK; at = after(&h, at)) {
		memcpy(&h, s->bytes + at, sizeof h);
		if (h.mark != STEP_MARK)
			continue;
		memcpy(&before, s->bytes + last[h.id], sizeof before);
		if (last[h.id] && before.version >= h.version) {
			before.mark = LOST_MARK;
			memcpy(s->bytes + last[h.id], &before, sizeof before);
			h.anew |= before.anew;
			memcpy(s->bytes + at, &h, sizeof h);
		}
		last[h.id] = at;
	}
	free(last);
	return last != NULL;
}

// Objects that a step names exist: those that it reads, and its neighbours, which are others, each once, ascending.
static bool names_objects(const ob_free_schedule *s, const step_head *h, const uint32_t *word)
{
	bool fine = true;
	for (uint32_t i = 0; i < h->reads; i++)
		fine &= word[2 * i] < s->objects;
	for (uint32_t i = 2 * h->reads; i < h->words; i++)
		fine &= word[i] < s->objects && word[i] != h->id && (i == 2 * h->reads || word[i] > word[i - 1]);
	return fine;
}

static int ascending(const void *x, const void *y)
{
	const uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
	return a < b ? -1 : a > b;
}

// Lists the versions that steps read, each once, with the number of its readers.
static void count_readers(versions *v, size_t reads)
{
	if (reads)
		qsort(v->name, reads, sizeof *v->name, ascending);
	for (size_t i = 0; i < reads; i++) {
		if (!i || v->name[i] != v->name[v->n - 1])
			v->name[v->n++] = v->name[i];
		v->readers[v->n - 1]++;
	}
}

// Finds all reads of all steps. false and e: a step names an object that does not exist, or there is no memory.
static bool find_reads(ob_free_schedule *s, ob_error *e)
{
	const size_t most = 2 * (s->size / (2 * sizeof(uint32_t)));
	step_head h = { 0 };
	size_t n = 0;
	if (!ob_budget_allows(2 * most * sizeof *s->wanted.name, e))
		return false;
	s->wanted.name = malloc(most * sizeof *s->wanted.name);
	for (size_t at = s->at; s->wanted.name && h.mark != END_MARK; at = after(&h, at)) {
		memcpy(&h, s->bytes + at, sizeof h);
		const uint32_t *word = words_at(s, at);
		if (h.mark == STEP_MARK && !names_objects(s, &h, word))
			return ob_fail(e, "damaged at byte %zu: the step names an object that does not exist", at);
		for (uint32_t i = 0; h.mark == STEP_MARK && i < h.reads; i++)
			for (uint32_t next = 0; next <= (word[2 * i + 1] & 1); next++)
				s->wanted.name[n++] = (uint64_t)word[2 * i] << 32 | ((word[2 * i + 1] >> 1) + next);
	}
	s->wanted.readers = calloc(n + 1, sizeof *s->wanted.readers);
	if (!s->wanted.name || !s->wanted.readers)
		return ob_fail(e, "no memory");
	count_readers(&s->wanted, n);
	return true;
}

// Readers of a version in steps to come; NULL: it never had any.
static uint32_t *readers_of(const ob_free_schedule *s, uint32_t id, uint64_t version)
{
	const uint64_t name = (uint64_t)id << 32 | version;
	const uint64_t *found =
		version > UINT32_MAX ? NULL : bsearch(&name, s->wanted.name, s->wanted.n, sizeof name, ascending);
	return found ? &s->wanted.readers[found - s->wanted.name] : NULL;
}

// Finds the next step from a place on.
static void seek(ob_free_schedule *s, size_t at)
{
	do {
		s->at = at;
		memcpy(&s->step, s->bytes + at, sizeof s->step);
		at = after(&s->step, at);
	} while (s->step.mark == LOST_MARK);
	s->taken = 0;
}

static bool load(ob_free_schedule *s, const char *path, uint32_t objects, ob_error *e)
{
	s->bytes = ob_file_load(path, most_bytes, &s->size, e);
	if (!s->bytes)
		return false;
	s->objects = objects;
	s->at = sizeof(file_head);
	s->kept = calloc(objects, sizeof(kept *));
	if (!check_steps(s->bytes, s->size, objects, e))
		return false;
	if (!s->kept || !mark_lost(s))
		return ob_fail(e, "no memory");
	if (!find_reads(s, e))
		return false;
	seek(s, s->at);
	return true;
}

bool ob_free_schedule_open(ob_free_schedule **out, ob_universe *u, ob_error *e)
{
	const ob_free_settings *f = ob_free_settings_of(u);
	*out = NULL;
	if (!*f->schedule)
		return true;
	ob_free_schedule *s = *out = calloc(1, sizeof *s);
	if (!s)
		return ob_fail(e, "no memory");
	s->fd = -1;
	if (f->replays) {
		ob_budget_begin();
		const bool good = load(s, f->schedule, ob_universe_capacity(u), e);
		ob_budget_end();
		return good;
	}
	s->fd = open(f->schedule, O_WRONLY | O_APPEND | O_CLOEXEC);
	return s->fd >= 0 || ob_fail(e, "%s", strerror(errno));
}

void ob_free_schedule_close(ob_free_schedule *s)
{
	if (!s)
		return;
	for (uint32_t id = 0; s->kept && id < s->objects; id++)
		for (kept *k = s->kept[id], *next; k; k = next)
			next = k->next, free(k);
	if (s->fd >= 0)
		close(s->fd);
	free(s->kept);
	free(s->wanted.name);
	free(s->wanted.readers);
	free(s->bytes);
	free(s->read);
	free(s->neighbour);
	free(s);
}

bool ob_free_schedule_replays(const ob_free_schedule *s)
{
	return s && s->bytes;
}

bool ob_free_schedule_is_fine(const ob_free_schedule *s, ob_error *e)
{
	return !s || !s->wrong || ob_fail(e, "%s", s->wrong);
}

void ob_free_schedule_refuse(ob_free_schedule *s)
{
	s->wrong = misfit;
}

bool ob_free_schedule_next(const ob_free_schedule *s, ob_free_planned_step *out)
{
	const step_head *h = &s->step;
	*out = (ob_free_planned_step){ .id = h->id, .version = h->version, .end = h->end, .anew = h->anew };
	return h->mark == STEP_MARK;
}

void ob_free_schedule_take(ob_free_schedule *s)
{
	seek(s, after(&s->step, s->at));
}

// ---- reading

static void note_read(ob_free_schedule *s, uint32_t id, uint64_t version, bool next)
{
	if (2 * (s->step.reads + 1) > s->reads_max) {
		s->reads_max = 2 * s->reads_max + 16;
		s->read = ob_reallocate(s->read, s->reads_max * sizeof *s->read);
	}
	s->read[2 * s->step.reads] = id;
	s->read[2 * s->step.reads++ + 1] = (uint32_t)version << 1 | next;
}

static kept *keep(ob_free_schedule *s, uint32_t id, uint64_t version, const ob_motion *m)
{
	const uint32_t *readers = readers_of(s, id, version);
	if (!readers || *readers == 0)
		return NULL;
	if (s->kept_bytes + sizeof(kept) > most_bytes) {
		s->wrong = "more versions wait for their readers than there is memory for";
		return NULL;
	}
	kept *k = ob_reallocate(NULL, sizeof *k);
	s->kept_bytes += sizeof *k;
	k->next = s->kept[id];
	k->version = version;
	k->readers = *readers;
	k->motion = *m;
	return s->kept[id] = k;
}

// Keeps the newest version, which the host may have made.
static void keep_newest(ob_free_schedule *s, const ob_universe *u, uint32_t id)
{
	ob_motion m, next;
	const uint64_t version = ob_free_version(u, id);
	for (const kept *k = s->kept[id]; k; k = k->next)
		if (k->version == version)
			return;
	if (version && ob_free_read(u, id, INFINITY, &m, &next) > 0)
		keep(s, id, version, &m);
}

// Returns a version for one of its readers. NULL: it is not there.
static const kept *find_kept(ob_free_schedule *s, const ob_universe *u, uint32_t id, uint64_t version)
{
	if (version == ob_free_version(u, id))
		keep_newest(s, u, id);
	kept *k = s->kept[id];
	while (k && k->version != version)
		k = k->next;
	if (!k)
		ob_free_schedule_refuse(s);
	return k;
}

// Forgets a version after its last reader.
static void release(ob_free_schedule *s, uint32_t id, uint64_t version)
{
	kept **at = &s->kept[id];
	--*readers_of(s, id, version);
	while (*at && (*at)->version != version)
		at = &(*at)->next;
	kept *k = *at;
	if (!k || --k->readers > 0)
		return;
	*at = k->next;
	s->kept_bytes -= sizeof *k;
	free(k);
}

// Returns the version that the step reads next; 0: none. next: the one after it was there, too.
static uint64_t take_read(ob_free_schedule *s, uint32_t id, bool *next)
{
	const uint32_t *read = words_at(s, s->at) + 2 * s->taken;
	if (s->taken >= s->step.reads || read[0] != id) {
		ob_free_schedule_refuse(s);
		return 0;
	}
	s->taken++;
	*next = read[1] & 1;
	return read[1] >> 1;
}

uint64_t ob_free_schedule_read(ob_free_schedule *s, const ob_universe *u, uint32_t id, double t, ob_motion *out,
			       ob_motion *next)
{
	bool has_next = false;
	if (!ob_free_schedule_replays(s)) {
		const uint64_t version = ob_free_read(u, id, t, out, next);
		if (s)
			note_read(s, id, version, version && next && !isnan(next->t0));
		return version;
	}
	const uint64_t version = take_read(s, id, &has_next);
	const kept *k = version ? find_kept(s, u, id, version) : NULL;
	if (!k)
		return 0;
	*out = k->motion;
	release(s, id, version);
	if (next)
		next->t0 = NAN;
	if (has_next && next && (k = find_kept(s, u, id, version + 1))) {
		*next = k->motion;
		release(s, id, version + 1);
	}
	return version;
}

// ---- neighbours, and the end of a step

bool ob_free_schedule_neighbours(const ob_free_schedule *s, const uint32_t **id, uint32_t *n)
{
	*id = words_at(s, s->at) + 2 * s->step.reads;
	*n = s->step.listed ? s->step.listed - 1 : 0;
	return s->step.listed;
}

void ob_free_schedule_note_neighbour(ob_free_schedule *s, uint32_t id)
{
	if (s->neighbours == s->neighbours_max) {
		s->neighbours_max = 2 * s->neighbours_max + 16;
		s->neighbour = ob_reallocate(s->neighbour, s->neighbours_max * sizeof *s->neighbour);
	}
	if (s->step.listed++)
		s->neighbour[s->neighbours++] = id;
}

// Appends the step by one write, so that steps of several workers do not mix.
static void append(ob_free_schedule *s)
{
	step_head *h = &s->step;
	h->mark = STEP_MARK;
	h->words = 2 * h->reads + s->neighbours;
	const size_t reads = 2 * h->reads * sizeof(uint32_t), all = sizeof *h + h->words * sizeof(uint32_t);
	char *bytes = ob_reallocate(NULL, all);
	uint32_t *word = (uint32_t *)(bytes + sizeof *h);
	if (h->reads)
		memcpy(word, s->read, reads);
	if (s->neighbours)
		memcpy(word + 2 * h->reads, s->neighbour, s->neighbours * sizeof *word);
	h->hash = hash_of(h, word);
	memcpy(bytes, h, sizeof *h);
	if (write(s->fd, bytes, all) != (ssize_t)all)
		s->wrong = "the file cannot be written";
	free(bytes);
	s->neighbours = 0;
	*h = (step_head){ 0 };
}

void ob_free_schedule_put(ob_free_schedule *s, const ob_universe *u, uint32_t id, const ob_motion *m, bool anew)
{
	if (!s)
		return;
	const uint64_t version = ob_free_version(u, id) + 1;
	if (!ob_free_schedule_replays(s)) {
		s->step.id = id;
		s->step.version = version;
		s->step.end = m->t0;
		s->step.anew = anew;
		append(s);
		return;
	}
	if (version != s->step.version)
		ob_free_schedule_refuse(s);
	keep_newest(s, u, id);
	keep(s, id, version, m);
}
