// obsim send: sends a request to a running universe, or reads its contacts, from another terminal or a program.
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/spelling.h"
#include "base/utf8.h"
#include "cli/command.h"
#include "host/ask.h"
#include "host/joining.h"
#include "host/request_table.h"
#include "table/table.h"

typedef struct sending {
	const char *universe;
	ob_universe *u;
	const ob_request_row *row;
	ob_words word; // after the verb
	ob_request request;
} sending;

// Finds an object by its number or its name.
static bool find_object(sending *s, const char *text, ob_error *e)
{
	char *end;
	ob_passport p;
	ob_spelling near = ob_spelling_start(text);
	char best[OB_NAME_MAX];
	const unsigned long number = strtoul(text, &end, 10);
	const bool by_number = *text && !*end && number < UINT32_MAX;
	for (uint32_t id = 0; id < ob_universe_ids(s->u); id++) {
		if (!ob_universe_get_passport(s->u, id, &p))
			continue;
		p.name[OB_NAME_MAX - 1] = 0;
		if (by_number ? id == number : strcmp(p.name, text) == 0) {
			s->request.id = id;
			s->request.generation = p.generation;
			return true;
		}
		if (!by_number)
			ob_spelling_offer(&near, p.name);
		near.best = near.best == p.name ? memcpy(best, p.name, sizeof best) : near.best;
	}
	return near.best ? ob_fail(e, "universe \"%s\" has no object \"%s\": did you mean \"%s\"?", s->universe, text,
				   near.best)
			 : ob_fail(e, "universe \"%s\" has no object \"%s\"", s->universe, text);
}

static bool find_target(sending *s, ob_error *e)
{
	return s->row->to == OB_TO_RUN     ? true
	       : s->row->to == OB_TO_JOINT ? ob_joint_request_find(s->u, s->word[0], &s->request, e)
					   : find_object(s, s->word[0], e);
}

static bool read_fields(sending *s, ob_error *e)
{
	ob_words word = s->word + (s->row->to != OB_TO_RUN);
	for (const ob_request_field *f = s->row->field; f->name && word; f++)
		if (*word || !f->optional)
			word = ob_request_read_field(&s->request, f, word, s->row->verb, e);
	return word;
}

// ---- requests of several parts, and looks

static bool ask_for(void *universe, ob_request *r, ob_error *e)
{
	return ob_ask(universe, r, e);
}

static bool create(sending *s, ob_error *e)
{
	return ob_create_as_scene(s->u, s->word[0], strlen(s->word[0]), 0, ask_for, s->u, e);
}

static bool read_path_of_file(sending *s, ob_error *e)
{
	char here[PATH_MAX] = "";
	const char *path = s->word[0];
	if (*path != '/' && !getcwd(here, sizeof here))
		return ob_fail(e, "save: there is no current directory");
	const int n =
		snprintf((char *)s->request.values, sizeof s->request.values, "%s%s%s", here, *here ? "/" : "", path);
	return n < (int)sizeof s->request.values || ob_fail(e, "save: the path is too long");
}

// Waits until the file has been replaced by another one, but not for ever.
static bool await_file(const char *path, const struct stat *before, ob_error *e)
{
	const double patience = 30, end = ob_clock_wall() + patience; // s
	struct stat now;
	while (ob_clock_wall() < end && nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL) == 0)
		if (stat(path, &now) == 0 &&
		    (now.st_ino != before->st_ino || now.st_mtim.tv_sec != before->st_mtim.tv_sec ||
		     now.st_mtim.tv_nsec != before->st_mtim.tv_nsec))
			return true;
	return ob_fail(e, "save: %s was not written: viewers are told why", path);
}

static bool save(sending *s, ob_error *e)
{
	const char *path = (const char *)s->request.values;
	struct stat before = { 0 };
	if (!read_path_of_file(s, e))
		return false;
	stat(path, &before);
	return ob_ask(s->u, &s->request, e) && await_file(path, &before, e);
}

// Waits until so many steps are complete.
static bool await_step(sending *s, ob_error *e)
{
	return ob_universe_wait(s->u, s->request.steps, INFINITY) ||
	       ob_fail(e, "universe \"%s\" ended after step %llu", s->universe,
		       (unsigned long long)ob_step_count(s->u));
}

static const char *name_in(const ob_universe *u, uint32_t id, ob_passport *p)
{
	if (!ob_universe_get_passport(u, id, p))
		return "-"; // it has gone since
	p->name[OB_NAME_MAX - 1] = 0;
	return p->name;
}

// Prints the contact points of the last step, of one object or of all.
static bool print_contacts(sending *s, ob_error *e)
{
	ob_contact_point *c = NULL;
	ob_passport a, b;
	size_t n, room = 0;
	if (s->word[0] && !find_object(s, s->word[0], e))
		return false;
	while ((n = ob_universe_get_contacts(s->u, c, room)) > room) {
		if (!OB_RESERVE(c, n, room)) {
			free(c);
			return ob_fail(e, "contacts: out of memory");
		}
	}
	for (size_t i = 0; i < n; i++)
		if (!s->word[0] || c[i].a == s->request.id || c[i].b == s->request.id)
			printf("%s  %s  %.9g %.9g %.9g  %.6g %.6g %.6g  %.6g\n", name_in(s->u, c[i].a, &a),
			       name_in(s->u, c[i].b, &b), c[i].position.x, c[i].position.y, c[i].position.z,
			       c[i].normal.x, c[i].normal.y, c[i].normal.z, c[i].impulse);
	free(c);
	return fflush(stdout) == 0 || ob_fail(e, "contacts: %s", strerror(errno));
}

// Prints the newest sample of a sensor, or of each: its name, the time, and the values.
static bool print_sensors(sending *s, ob_error *e)
{
	double value[OB_SENSOR_VALUES_MAX], time;
	ob_sensor_passport p;
	uint64_t number;
	bool found = !s->word[0];
	for (uint32_t i = 0; i < ob_universe_sensors(s->u); i++) {
		if (!ob_universe_get_sensor(s->u, i, &p) || (s->word[0] && strcmp(p.name, s->word[0]) != 0))
			continue;
		const bool is_camera = p.kind == OB_SENSOR_CAMERA;
		const bool taken = ob_universe_get_samples(s->u, i, 0, &number, &time, is_camera ? NULL : value, 1);
		found = true;
		ob_utf8_make_plain(p.name);
		printf("%s  ", p.name);
		printf(taken ? "%.9g " : "- ", time);
		if (is_camera)
			printf(" picture %llu, %ux%u", taken ? (unsigned long long)number : 0ULL, p.beams, p.rows);
		for (uint32_t k = 0; taken && !is_camera && k < p.width; k++)
			printf(" %.9g", value[k]);
		puts("");
	}
	if (!found)
		return ob_fail(e, "sensors: there is no sensor \"%s\"", s->word[0]);
	return fflush(stdout) == 0 || ob_fail(e, "sensors: %s", strerror(errno));
}

// ---- rows

void ob_send_help(FILE *f)
{
	fputs("\nRequests:\n", f);
	for (const ob_request_row *row = ob_request_rows; row->kind != OB_REQUEST_ROWS_END; row++) {
		char usage[128];
		if (!row->verb)
			continue;
		ob_request_usage(row, usage, sizeof usage);
		fprintf(f, *row->what ? "  obsim send NAME %-50s %s\n" : "  obsim send NAME %s%s\n", usage, row->what);
	}
}

static const ob_request_row *find_row(const char *name, ob_error *e)
{
	ob_spelling near = ob_spelling_start(name ? name : "");
	char all[sizeof e->text] = "";
	for (const ob_request_row *row = ob_request_rows; row->kind != OB_REQUEST_ROWS_END; row++) {
		if (!row->verb)
			continue;
		if (name && strcmp(row->verb, name) == 0)
			return row;
		ob_spelling_offer(&near, row->verb);
		snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", *all ? ", " : "", row->verb);
	}
	if (name && near.best)
		ob_fail(e, "unknown request '%s': did you mean %s?", name, near.best);
	else
		ob_fail(e, "expected a request: obsim send NAME with one of %s", all);
	return NULL;
}

// True if the row takes so many words.
static bool takes(const ob_request_row *row, int count)
{
	int least = row->to != OB_TO_RUN, most = least;
	for (const ob_request_field *f = row->field; f->name; f++) {
		const bool numbers = f->type == OB_AS_REALS || f->type == OB_AS_ATTITUDE;
		const int some = numbers ? f->count : f->type != OB_AS_WORDS;
		least += f->optional ? 0 : some;
		most = f->type == OB_AS_WORDS || f->type == OB_AS_PATH ? INT_MAX / 2 : most + some;
	}
	return count >= least && count <= most;
}

// A universe that starts has neither objects nor an address yet: waits until it runs, but not for ever.
static void wait_for_start(const ob_universe *u)
{
	const double patience = 10, end = ob_clock_wall() + patience; // s
	ob_universe_info info;
	do {
		ob_universe_get_info(u, &info);
	} while (info.state == OB_UNIVERSE_STARTING && ob_universe_is_hosted(u) && ob_clock_wall() < end &&
		 nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL) == 0);
}

// Reads and finds what the words mean, and asks for it.
static bool send(sending *s, ob_error *e)
{
	ob_request_begin(&s->request, s->row);
	if (!read_fields(s, e))
		return false;
	switch (s->row->kind) {
	case OB_REQUEST_ADD:
		return create(s, e);
	case OB_REQUEST_SAVE:
		return save(s, e);
	case OB_LOOK_WAIT:
		return await_step(s, e);
	case OB_LOOK_POINTS:
		return print_contacts(s, e);
	case OB_LOOK_SENSED:
		return print_sensors(s, e);
	default:
		return find_target(s, e) && ob_ask(s->u, &s->request, e);
	}
}

int ob_command_send(const ob_arguments *a)
{
	ob_error e;
	char usage[128];
	if (!a->operand)
		return ob_command_fail(OB_EXIT_USAGE, "no universe given: obsim send NAME remove OBJECT");
	sending s = { .universe = a->operand, .row = find_row(a->operands[1], &e) };
	if (!s.row)
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	int count = 0;
	for (s.word = a->operands + 2; s.word[count];)
		count++;
	if (!takes(s.row, count)) {
		ob_request_usage(s.row, usage, sizeof usage);
		ob_fail(&e, "%s: expected obsim send %s %s", s.row->verb, a->operand, usage);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	s.u = ob_universe_attach(s.universe, &e);
	if (s.u)
		wait_for_start(s.u);
	const bool fine = s.u && send(&s, &e);
	ob_universe_detach(s.u);
	return fine ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, e.text);
}
