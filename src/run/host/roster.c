#include "host/roster.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <urcu/urcu-memb.h>

#include "host/rcu_tsan.h"

// Entry as it is stored: names take only their own length.
typedef struct kept {
	uint32_t id, generation, origin;
	uint32_t name; // offset in the snapshot's names
	uint8_t script;
	bool own_worker;
} kept;

typedef struct snapshot {
	uint64_t number;
	size_t n;
	char *names; // behind the entries, each with its final 0
	kept entry[];
} snapshot;

struct ob_roster {
	snapshot *current; // never NULL
};

// ---- a thread registers with RCU at its first read, and is unregistered when it ends

static pthread_key_t thread_end;
static pthread_once_t thread_end_made = PTHREAD_ONCE_INIT;
static __thread bool registered;

static void unregister(void *key)
{
	(void)key;
	urcu_memb_unregister_thread();
}
static void create_thread_end_key(void)
{
	pthread_key_create(&thread_end, unregister);
}

static void read_lock(void)
{
	if (!registered) {
		pthread_once(&thread_end_made, create_thread_end_key);
		urcu_memb_register_thread();
		pthread_setspecific(thread_end, &registered);
		registered = true;
	}
	urcu_memb_read_lock();
}

static const snapshot *lock_snapshot(const ob_roster *r)
{
	read_lock();
	const snapshot *s = rcu_dereference(r->current);
	OB_ORDER_AFTER(s);
	return s;
}

static void unlock_snapshot(const snapshot *s)
{
	OB_ORDER_BEFORE(s);
	urcu_memb_read_unlock();
}

// ---- the writer

static size_t name_length(const ob_roster_entry *entry)
{
	return strnlen(entry->name, OB_NAME_MAX - 1);
}

static snapshot *new_snapshot(uint64_t number, const ob_roster_entry *entries, size_t n)
{
	size_t bytes = 0;
	for (size_t i = 0; i < n; i++)
		bytes += name_length(&entries[i]) + 1;
	snapshot *s = malloc(sizeof *s + n * sizeof *s->entry + bytes);
	if (!s)
		return NULL;
	s->number = number;
	s->n = n;
	s->names = (char *)(s->entry + n);
	uint32_t at = 0;
	for (size_t i = 0; i < n; i++) {
		const ob_roster_entry *from = &entries[i];
		const size_t length = name_length(from);
		s->entry[i] = (kept){ from->id, from->generation, from->origin, at, from->script, from->own_worker };
		memcpy(s->names + at, from->name, length);
		s->names[at + length] = 0;
		at += (uint32_t)length + 1;
	}
	OB_ORDER_BEFORE(s);
	return s;
}

ob_roster *ob_roster_create(void)
{
	ob_roster *r = calloc(1, sizeof *r);
	if (r && !(r->current = new_snapshot(0, NULL, 0))) {
		free(r);
		return NULL;
	}
	return r;
}

void ob_roster_destroy(ob_roster *r)
{
	if (!r)
		return;
	OB_ORDER_AFTER(r->current);
	free(r->current);
	free(r);
}

bool ob_roster_publish(ob_roster *r, const ob_roster_entry *entries, size_t n)
{
	snapshot *fresh = new_snapshot(r->current->number + 1, entries, n);
	if (!fresh)
		return false;
	snapshot *old = rcu_xchg_pointer(&r->current, fresh);
	urcu_memb_synchronize_rcu();
	OB_ORDER_AFTER(old);
	free(old);
	return true;
}

// ---- readers

uint64_t ob_roster_number(const ob_roster *r)
{
	const snapshot *s = lock_snapshot(r);
	uint64_t number = s->number;
	unlock_snapshot(s);
	return number;
}

static ob_roster_entry whole(const snapshot *s, const kept *of)
{
	ob_roster_entry entry = { .id = of->id,
				  .generation = of->generation,
				  .origin = of->origin,
				  .script = of->script,
				  .own_worker = of->own_worker };
	strcpy(entry.name, s->names + of->name);
	return entry;
}

size_t ob_roster_copy(const ob_roster *r, ob_roster_entry *out, size_t max)
{
	const snapshot *s = lock_snapshot(r);
	const size_t n = s->n;
	for (size_t i = 0; i < n && i < max; i++)
		out[i] = whole(s, &s->entry[i]);
	unlock_snapshot(s);
	return n;
}

static int by_id(const void *key, const void *entry)
{
	uint32_t a = *(const uint32_t *)key, b = ((const kept *)entry)->id;
	return (a > b) - (a < b);
}

bool ob_roster_find(const ob_roster *r, uint32_t id, ob_roster_entry *out)
{
	const snapshot *s = lock_snapshot(r);
	const kept *found = bsearch(&id, s->entry, s->n, sizeof *s->entry, by_id);
	if (found)
		*out = whole(s, found);
	unlock_snapshot(s);
	return found != NULL;
}
