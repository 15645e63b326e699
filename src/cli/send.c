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
#include "cli/command.h"
#include "host/ask.h"
#include "host/joining.h"
#include "host/pull.h"
#include "shape/shape.h"
#include "table/table.h"

typedef struct sending {
	const char *universe;
	ob_universe *u;
	const char *const *word; // after the verb; NULL ends
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

// Creates objects with the syntax of scenes: one call, or several.
static bool create(sending *s, ob_error *e)
{
	const char *text = s->word[0];
	const ob_scene_options options = { .joining = true, .find = ob_joined_find, .with = s->u };
	ob_scene *scene = ob_scene_load_text("obsim send", text, strlen(text), &options, e);
	bool fine = scene;
	for (uint32_t i = 0; fine && i < scene->objects; i++) {
		const ob_object_def *def = &scene->object[i];
		s->request = (ob_request){ .kind = OB_REQUEST_ADD, .def = *def };
		if (ob_shape_is(def->passport.shape, OB_HULLED))
			s->request.corners = scene->hull_corners[def->passport.hull];
		if (def->script || def->born > 0 || def->dies < INFINITY)
			fine = ob_fail(e, "create: expected an object without script, born and dies");
		else if (def->path || def->force)
			fine = ob_fail(e,
				       "create: expected neither path nor varying_force: a scene's objects have them");
		fine = fine && ob_ask(s->u, &s->request, e);
	}
	for (uint32_t i = 0; fine && i < scene->joints; i++) {
		ob_joint_request_make(&s->request, &scene->joint[i]);
		fine = ob_ask(s->u, &s->request, e);
	}
	ob_scene_free(scene);
	return fine;
}

static bool find_joint(sending *s, const char *name, ob_error *e)
{
	return ob_joint_request_find(s->u, name, &s->request, e);
}

static bool read_colour(sending *s, ob_error *e)
{
	return ob_scene_read_colour(s->word[1], s->request.colour) ||
	       ob_fail(e, "colour: expected \"#rrggbb\", got \"%s\"", s->word[1]);
}

static bool read_values(sending *s, ob_error *e)
{
	for (int i = 1; s->word[i]; i++)
		if (!ob_scene_put_value(s->word[i], s->request.values, &s->request.bytes, sizeof s->request.values))
			return ob_fail(e, "message: at most %zu bytes can be sent", sizeof s->request.values);
	return true;
}

static bool read_number(const char *verb, const char *word, double *out, ob_error *e)
{
	char *end;
	*out = strtod(word, &end);
	return (*word && !*end) || ob_fail(e, "%s: expected a number, got \"%s\"", verb, word);
}

static bool read_motor(sending *s, ob_error *e)
{
	return read_number("motor", s->word[1], &s->request.motor, e);
}

static bool read_friction(sending *s, ob_error *e)
{
	return read_number("friction", s->word[1], &s->request.friction, e);
}

static bool read_steps(sending *s, ob_error *e)
{
	double steps = 1;
	if (s->word[0] && !read_number("step", s->word[0], &steps, e))
		return false;
	s->request.steps = steps >= 0 && steps == floor(steps) && steps < 1e18 ? (uint64_t)steps : 0;
	return true;
}

static bool read_until(sending *s, ob_error *e)
{
	return read_number("until", s->word[0], &s->request.until, e);
}

static bool read_rate(sending *s, ob_error *e)
{
	return read_number("rate", s->word[0], &s->request.rate, e);
}

// Reads three numbers from word i on.
static bool read_vector(const sending *s, int i, ob_vec3 *out, ob_error *e)
{
	double v[3];
	for (int k = 0; k < 3; k++) {
		char *end;
		const char *word = s->word[i + k] ? s->word[i + k] : "";
		v[k] = strtod(word, &end);
		if (!*word || *end)
			return ob_fail(e, "expected three numbers after the object, got \"%s\"", word);
	}
	*out = ob_v3(v[0], v[1], v[2]);
	return true;
}

// Reads a vector and, if there are more words, a point of the object's body.
static bool read_pull(sending *s, ob_vec3 *value, ob_error *e)
{
	return read_vector(s, 1, value, e) && (!s->word[4] || read_vector(s, 4, &s->request.point, e));
}

static bool read_force(sending *s, ob_error *e)
{
	return read_pull(s, &s->request.force, e);
}

static bool read_twist(sending *s, ob_error *e)
{
	return read_pull(s, &s->request.twist, e);
}

static bool read_target(sending *s, ob_error *e)
{
	s->request.frequency = OB_PULL_FREQUENCY;
	return read_pull(s, &s->request.target, e);
}

// A state that stays as it is, but for a part.
static ob_state same_state(void)
{
	return (ob_state){ { { NAN, 0, 0 }, { NAN, 0, 0, 0 } }, { NAN, 0, 0 }, { NAN, 0, 0 } };
}

static bool read_place(sending *s, ob_error *e)
{
	s->request.state = same_state();
	return read_pull(s, &s->request.state.pose.p, e);
}

static bool read_velocity(sending *s, ob_error *e)
{
	s->request.state = same_state();
	return read_pull(s, &s->request.state.v, e);
}

static bool read_spin(sending *s, ob_error *e)
{
	s->request.state = same_state();
	return read_pull(s, &s->request.state.w, e);
}

static bool read_attitude(sending *s, ob_error *e)
{
	ob_quat *q = &s->request.state.pose.q;
	ob_vec3 v = { 0 };
	s->request.state = same_state();
	if (!read_number("attitude", s->word[1], &q->w, e) || !read_vector(s, 2, &v, e))
		return false;
	q->x = v.x, q->y = v.y, q->z = v.z;
	return true;
}

static bool read_surface(sending *s, ob_error *e)
{
	return read_pull(s, &s->request.surface_velocity, e);
}

// Reads a point of a path from one word: "T X Y Z", or "T X Y Z QW QX QY QZ", as the first one has it.
static bool read_point(const char *word, ob_request_path *path, ob_error *e)
{
	enum { PLACED = 4, TURNED = 8 };
	double x[TURNED] = { [PLACED] = 1 };
	int n = 0;
	const char *at = word;
	for (char *end; n < TURNED; n++, at = end) {
		x[n] = strtod(at, &end);
		if (end == at)
			break;
	}
	const bool turns = n == TURNED;
	if (at[strspn(at, " ")] || (n != PLACED && !turns) || (path->points > 0 && turns != path->turns))
		return ob_fail(e,
			       "path: expected points as '1.5 0 0 2' or, each of them, '1.5 0 0 2 1 0 0 0', got \"%s\"",
			       word);
	if (path->points == OB_REQUEST_POINTS)
		return ob_fail(e, "path: expected at most %d points", OB_REQUEST_POINTS);
	path->turns = turns;
	path->point[path->points++] = (ob_path_point){ x[0], ob_v3(x[1], x[2], x[3]), { x[4], x[5], x[6], x[7] } };
	return true;
}

static bool read_path(sending *s, ob_error *e)
{
	for (int i = 1; s->word[i]; i++) {
		s->request.path.loop = !s->word[i + 1] && strcmp(s->word[i], "loop") == 0;
		if (!s->request.path.loop && !read_point(s->word[i], &s->request.path, e))
			return false;
	}
	return true;
}

static bool read_parameter(sending *s, ob_error *e)
{
	double value;
	const int n = snprintf((char *)s->request.values, sizeof s->request.values, "%s=%s", s->word[0], s->word[1]);
	return read_number("set", s->word[1], &value, e) &&
	       (n < (int)sizeof s->request.values || ob_fail(e, "set: expected a parameter's name"));
}

static bool read_whole(const char *verb, const char *word, uint64_t *out, ob_error *e)
{
	char *end;
	errno = 0;
	*out = strtoull(word, &end, 10);
	return (strspn(word, "0123456789") > 0 && !*end && !errno) ||
	       ob_fail(e, "%s: expected a whole number, got \"%s\"", verb, word);
}

static bool read_seed(sending *s, ob_error *e)
{
	return read_whole("seed", s->word[0], &s->request.seed, e);
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
	s->request.kind = OB_REQUEST_SAVE;
	return ob_ask(s->u, &s->request, e) && await_file(path, &before, e);
}

// Waits until so many steps are complete.
static bool await_step(sending *s, ob_error *e)
{
	uint64_t step = 0;
	return read_whole("wait", s->word[0], &step, e) &&
	       (ob_universe_wait(s->u, step, INFINITY) ||
		ob_fail(e, "universe \"%s\" ended after step %llu", s->universe,
			(unsigned long long)ob_step_count(s->u)));
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
		room = n + n / 4;
		if (!OB_GROW(c, room)) {
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

static bool read_worker(sending *s, ob_error *e)
{
	char *end;
	const unsigned long worker = strtoul(s->word[1], &end, 10);
	if (strspn(s->word[1], "0123456789") == 0 || *end || worker >= UINT32_MAX)
		return ob_fail(e, "move: expected the number of a worker, got \"%s\"", s->word[1]);
	s->request.worker = (uint32_t)worker;
	return true;
}

static const struct verb {
	const char *name, *usage, *what;
	int words; // at least
	int more; // than these, at most
	ob_request_kind kind; // OB_REQUEST_KINDS: none
	bool (*find)(sending *s, const char *word, ob_error *e); // whom the first word names; NULL: nobody
	bool (*read)(sending *s, ob_error *e); // the other words; NULL: there are none. Without a kind it does all
} verbs[] = {
	{ "create", "create 'sphere { radius = .3, at = { 0, 0, 5 } }'", "as a scene says it", 1, 0, OB_REQUEST_KINDS,
	  NULL, create },
	{ "remove", "remove OBJECT", "by its name or number", 1, 0, OB_REQUEST_REMOVE, find_object, NULL },
	{ "colour", "colour OBJECT '#rrggbb'", "", 2, 0, OB_REQUEST_COLOUR, find_object, read_colour },
	{ "message", "message OBJECT VALUE ...", "for its on_message", 1, INT_MAX - 1, OB_REQUEST_MESSAGE, find_object,
	  read_values },
	{ "force", "force OBJECT X Y Z", "N, from now on", 4, 0, OB_REQUEST_FORCE, find_object, read_force },
	{ "kick", "kick OBJECT X Y Z", "N s", 4, 0, OB_REQUEST_KICK, find_object, read_force },
	{ "torque", "torque OBJECT X Y Z", "N m, from now on", 4, 0, OB_REQUEST_TORQUE, find_object, read_twist },
	{ "push", "push OBJECT X Y Z [POINT-X POINT-Y POINT-Z]", "N, at a point of it (m)", 4, 3, OB_REQUEST_PUSH,
	  find_object, read_force },
	{ "drag", "drag OBJECT X Y Z [POINT-X POINT-Y POINT-Z]", "to a place (m), by a point of it", 4, 3,
	  OB_REQUEST_DRAG, find_object, read_target },
	{ "release", "release OBJECT", "ends torque, push and drag", 1, 0, OB_REQUEST_RELEASE, find_object, NULL },
	{ "place", "place OBJECT X Y Z", "m", 4, 0, OB_REQUEST_STATE, find_object, read_place },
	{ "velocity", "velocity OBJECT X Y Z", "m/s", 4, 0, OB_REQUEST_STATE, find_object, read_velocity },
	{ "attitude", "attitude OBJECT W X Y Z", "a unit quaternion", 5, 0, OB_REQUEST_STATE, find_object,
	  read_attitude },
	{ "spin", "spin OBJECT X Y Z", "rad/s", 4, 0, OB_REQUEST_STATE, find_object, read_spin },
	{ "surface", "surface OBJECT X Y Z", "m/s, of a belt", 4, 0, OB_REQUEST_SURFACE, find_object, read_surface },
	{ "path", "path OBJECT 'T X Y Z [QW QX QY QZ]' ... [loop]", "of a kinematic object: s from now on, m", 2,
	  INT_MAX - 2, OB_REQUEST_PATH, find_object, read_path },
	{ "friction", "friction OBJECT NUMBER", "", 2, 0, OB_REQUEST_FRICTION, find_object, read_friction },
	{ "motor", "motor JOINT TARGET", "of a joint, by its name", 2, 0, OB_REQUEST_MOTOR, find_joint, read_motor },
	{ "unjoin", "unjoin JOINT", "removes a joint", 1, 0, OB_REQUEST_UNJOIN, find_joint, NULL },
	{ "move", "move OBJECT WORKER", "its simulator, to another worker", 2, 0, OB_REQUEST_MOVE, find_object,
	  read_worker },
	{ "kill", "kill OBJECT", "its simulator", 1, 0, OB_REQUEST_KILL, find_object, NULL },
	{ "keep", "keep", "a snapshot of a served universe", 0, 0, OB_REQUEST_KEEP, NULL, NULL },
	{ "return", "return", "to that snapshot, or to the start", 0, 0, OB_REQUEST_RETURN, NULL, NULL },
	{ "restart", "restart", "to the start", 0, 0, OB_REQUEST_RESTART, NULL, NULL },
	{ "set", "set PARAMETER NUMBER", "starts anew with another parameter", 2, 0, OB_REQUEST_SET, NULL,
	  read_parameter },
	{ "seed", "seed NUMBER", "starts anew with another seed", 1, 0, OB_REQUEST_SEED, NULL, read_seed },
	{ "save", "save FILE", "a served universe, as a checkpoint", 1, 0, OB_REQUEST_KINDS, NULL, save },
	{ "wait", "wait STEP", "until so many steps are complete", 1, 0, OB_REQUEST_KINDS, NULL, await_step },
	{ "contacts", "contacts [OBJECT]", "prints those of the last step", 0, 1, OB_REQUEST_KINDS, NULL,
	  print_contacts },
	{ "pause", "pause", "a served universe", 0, 0, OB_REQUEST_PAUSE, NULL, NULL },
	{ "resume", "resume", "", 0, 0, OB_REQUEST_RESUME, NULL, NULL },
	{ "step", "step [STEPS]", "while time stands (1)", 0, 1, OB_REQUEST_STEP, NULL, read_steps },
	{ "until", "until SECONDS", "this simulated time, and stands", 1, 0, OB_REQUEST_UNTIL, NULL, read_until },
	{ "rate", "rate NUMBER", "simulated seconds a second; 0: as fast as it can", 1, 0, OB_REQUEST_RATE, NULL,
	  read_rate },
};
enum { VERBS = sizeof verbs / sizeof *verbs };

void ob_send_help(FILE *f)
{
	fputs("\nRequests:\n", f);
	for (int i = 0; i < VERBS; i++)
		fprintf(f, *verbs[i].what ? "  obsim send NAME %-50s %s\n" : "  obsim send NAME %s%s\n", verbs[i].usage,
			verbs[i].what);
}

// Lists all requests.
static void refuse_all(ob_error *e)
{
	char text[sizeof e->text] = "";
	for (int i = 0; i < VERBS; i++)
		snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", i ? ", " : "", verbs[i].name);
	ob_fail(e, "expected a request: obsim send NAME with one of %s", text);
}

static const struct verb *find_verb(const char *name, ob_error *e)
{
	ob_spelling near = ob_spelling_start(name ? name : "");
	for (int i = 0; name && i < VERBS; i++) {
		if (strcmp(verbs[i].name, name) == 0)
			return &verbs[i];
		ob_spelling_offer(&near, verbs[i].name);
	}
	if (name && near.best)
		ob_fail(e, "unknown request '%s': did you mean %s?", name, near.best);
	else
		refuse_all(e);
	return NULL;
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
static bool send(sending *s, const struct verb *v, ob_error *e)
{
	if (v->kind == OB_REQUEST_KINDS)
		return v->read(s, e);
	s->request.kind = v->kind;
	return (!v->read || v->read(s, e)) && (!v->find || v->find(s, s->word[0], e)) && ob_ask(s->u, &s->request, e);
}

int ob_command_send(const ob_arguments *a)
{
	ob_error e;
	if (!a->operand)
		return ob_command_fail(OB_EXIT_USAGE, "no universe given: obsim send NAME remove OBJECT");
	const struct verb *v = find_verb(a->operands[1], &e);
	int words = 0;
	while (v && a->operands[2 + words])
		words++;
	if (v && (words < v->words || words - v->words > v->more))
		ob_fail(&e, "%s: expected obsim send %s %s", v->name, a->operand, v->usage);
	if (!v || words < v->words || words - v->words > v->more)
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	sending s = { .universe = a->operand, .word = a->operands + 2 };
	s.u = ob_universe_attach(s.universe, &e);
	if (s.u)
		wait_for_start(s.u);
	const bool fine = s.u && send(&s, v, &e);
	ob_universe_detach(s.u);
	return fine ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, e.text);
}
