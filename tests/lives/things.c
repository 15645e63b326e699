#include "things.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <zip.h>

#include "base/random.h"
#include "import/import.h"

// ---- writer

void put(writer *w, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	w->used += vsnprintf(w->to + w->used, w->size - (size_t)w->used, format, args);
	va_end(args);
	if ((size_t)w->used >= w->size)
		abort(); // the text is larger than a life may be
}

double within(writer *w, double low, double high)
{
	return ob_splitmix_within(&w->seed, low, high);
}

bool one_in(writer *w, unsigned n)
{
	return ob_splitmix(&w->seed) % n == 0;
}

void put_vector(writer *w, const char *name, double low, double high)
{
	const double x = within(w, low, high), y = within(w, low, high);
	put(w, " %s = { %.3f, %.3f, %.3f },", name, x, y, within(w, low, high));
}

static unsigned below(writer *w, unsigned n)
{
	return (unsigned)(ob_splitmix(&w->seed) % n);
}

// ---- files

static char folder[200];
static pid_t owner;

static void remove_folder(void)
{
	char command[240];
	if (getpid() != owner)
		return; // a life's process
	snprintf(command, sizeof command, "rm -rf '%s'", folder);
	if (system(command) != 0)
		perror(folder);
}

const char *things_folder(void)
{
	if (!*folder) {
		snprintf(folder, sizeof folder, "/tmp/obsim-lives-XXXXXX");
		if (!mkdtemp(folder))
			abort();
		owner = getpid();
		atexit(remove_folder);
	}
	return folder;
}

void things_use_folder(const char *path)
{
	snprintf(folder, sizeof folder, "%s", path);
}

// Triangles of a rough floor with holes; or any, across each other.
static uint32_t draw_triangles(writer *w, float (*vertex)[3], uint32_t (*corner)[3], uint32_t *vertices)
{
	enum { SIDE = 7 };
	const bool soup = one_in(w, 3);
	uint32_t n = 0;
	*vertices = soup ? 3 * (2 + below(w, 30)) : SIDE * SIDE;
	for (uint32_t i = 0; i < *vertices; i++) {
		vertex[i][0] = soup ? (float)within(w, -2, 2) : (float)(i % SIDE) - 3; // glTF: y is up
		vertex[i][1] = (float)within(w, 0, soup ? 1 : .3);
		vertex[i][2] = soup ? (float)within(w, -2, 2) : 3 - (float)(i / SIDE);
	}
	if (soup)
		for (; n < *vertices / 3; n++)
			memcpy(corner[n], (uint32_t[3]){ 3 * n, 3 * n + 1, 3 * n + 2 }, sizeof *corner);
	for (uint32_t i = 0; i < SIDE * (SIDE - 1) && !soup; i++) {
		if (i % SIDE == SIDE - 1 || one_in(w, 10))
			continue;
		memcpy(corner[n++], (uint32_t[3]){ i, i + 1, i + SIDE + 1 }, sizeof *corner);
		memcpy(corner[n++], (uint32_t[3]){ i, i + SIDE + 1, i + SIDE }, sizeof *corner);
	}
	return n;
}

// Writes a binary glTF file; returns its name.
static const char *write_mesh(writer *w, const things *t)
{
	static char name[64];
	static float vertex[100][3];
	static uint32_t corner[100][3];
	char path[300], json[1000];
	uint32_t vertices;
	const uint32_t n = draw_triangles(w, vertex, corner, &vertices), places = vertices * 12, corners = n * 12;
	int words = snprintf(json, sizeof json,
			     "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{"
			     "\"attributes\":"
			     "{\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":"
			     "5126,\"count\":%u,"
			     "\"type\":\"VEC3\",\"min\":[-4,-4,-4],\"max\":[4,4,4]},{\"bufferView\":1,"
			     "\"componentType\":5125,\"count\":"
			     "%u,\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%u},{\"buffer\":0,"
			     "\"byteOffset\":"
			     "%u,\"byteLength\":%u}],\"buffers\":[{\"byteLength\":%u}]}",
			     vertices, 3 * n, places, places, corners, places + corners);
	while (words % 4)
		json[words++] = ' ';
	const uint32_t bytes = places + corners,
		       head[5] = { 0x46546c67, 2, 28 + (uint32_t)words + bytes, (uint32_t)words, 0x4e4f534a },
		       data[2] = { bytes, 0x004e4942 };
	snprintf(name, sizeof name, "%llu-%u.glb", (unsigned long long)t->life, t->meshes);
	snprintf(path, sizeof path, "%s/%s", things_folder(), name);
	FILE *f = fopen(path, "wb");
	if (!f)
		abort();
	fwrite(head, sizeof head, 1, f);
	fwrite(json, 1, (size_t)words, f);
	fwrite(data, sizeof data, 1, f);
	fwrite(vertex, 1, places, f);
	fwrite(corner, 1, corners, f);
	if (fclose(f) != 0)
		abort();
	return name;
}

// ---- joints

static void put_axis(writer *w, double range)
{
	if (one_in(w, 3))
		put(w, " low = %.3f, high = %.3f, restitution = %.2f,", within(w, -range, -.01), within(w, .01, range),
		    within(w, 0, 1));
	if (one_in(w, 3))
		put(w, " stiffness = %.1f, damping = %.2f,", within(w, 0, 200), within(w, 0, 5));
	if (one_in(w, 5))
		put(w, " friction = %.2f,", within(w, 0, 20));
	if (one_in(w, 5))
		put(w, " armature = %.4f,", within(w, 0, .1));
	if (one_in(w, 4))
		put(w, " motor = { rate = %.2f, most = %.1f },", within(w, -6, 6), within(w, .1, 200));
	else if (one_in(w, 4))
		put(w, " motor = { to = %.3f, stiffness = %.1f, damping = %.2f },", within(w, -range, range),
		    within(w, 1, 300), within(w, 0, 9));
}

static void put_ball(writer *w)
{
	if (one_in(w, 3))
		put(w, " high = %.3f,", within(w, .1, 2.9));
	if (one_in(w, 3))
		put(w, " stiffness = %.1f, damping = %.2f,", within(w, 0, 50), within(w, 0, 2));
	if (one_in(w, 6))
		put(w, " armature = %.4f,", within(w, 0, .05));
}

void put_joint(writer *w, const char *a, const char *b, ob_vec3 at, const char *name)
{
	static const char *const kinds[] = { "ball", "hinge", "slider", "fixed", "universal", "distance", "apart" };
	const unsigned kind = below(w, *b ? 7 : 6);
	put(w, "%s { '%s',", kinds[kind], a);
	if (*b)
		put(w, " '%s',", b);
	if (kind < 6)
		put(w, " name = '%s',", name);
	if (kind == 5 && !*b)
		put(w, " to = { %.3f, %.3f, %.3f },", at.x + .5, at.y, at.z + .5);
	else if (kind < 5)
		put(w, " at = { %.3f, %.3f, %.3f },", at.x, at.y, at.z);
	if (kind == 1 || kind == 2 || kind == 4)
		put_vector(w, "axis", .05, 1);
	if (kind == 4)
		put_vector(w, "across", -1, -.05);
	if (kind == 0)
		put_ball(w);
	else if (kind == 1 || kind == 2)
		put_axis(w, kind == 1 ? 3 : .5);
	else if (kind == 5 && one_in(w, 2))
		put(w, " low = %.3f, high = %.3f, stiffness = %.1f, damping = %.2f,", within(w, .01, .2),
		    within(w, .3, 2), within(w, 0, 300), within(w, 0, 5));
	if (kind == 4 && one_in(w, 2)) {
		put(w, " low = -1, high = %.2f, second = {", within(w, .1, 2));
		put_axis(w, 2);
		put(w, " },");
	}
	if (kind < 6 && one_in(w, 3))
		put(w, " breaks_at = { %s = %.2f },", one_in(w, 2) ? "force" : "torque", within(w, 1, 400));
	if (kind < 6 && one_in(w, 6))
		put(w, " collide = true,");
	put(w, " }\n");
}

// ---- bodies

static void put_points(writer *w)
{
	put(w, " points = {");
	for (unsigned n = 4 + below(w, 9); n-- > 0;)
		put(w, " { %.3f, %.3f, %.3f },", within(w, -.25, .25), within(w, -.25, .25), within(w, -.2, .2));
	put(w, " },");
}

static void put_parts(writer *w)
{
	put(w, " parts = {");
	for (unsigned n = 1 + below(w, 4); n-- > 0;) {
		const unsigned shape = below(w, 5);
		put(w, " {");
		if (shape == 0)
			put_points(w);
		else if (shape == 1)
			put(w, " radius = %.3f,", within(w, .04, .15));
		else if (shape < 4)
			put(w, " shape = '%s', radius = %.3f, length = %.3f,", shape == 2 ? "capsule" : "cylinder",
			    within(w, .03, .1), within(w, .05, .4));
		else
			put_vector(w, "size", .03, .4);
		put_vector(w, "at", -.2, .2);
		if (one_in(w, 2))
			put(w, " rotation = { axis = { 1, .3, -.6 }, degrees = %.1f },", within(w, -180, 180));
		put(w, " },");
	}
	put(w, " },");
}

// Opens a body of any shape.
static void put_body(writer *w, bool compounds)
{
	static const char *const calls[] = { "sphere", "box", "capsule", "cylinder", "hull", "compound" };
	const unsigned shape = below(w, compounds ? 6 : 5);
	put(w, "%s {", calls[shape]);
	if (shape == 1)
		put_vector(w, "size", .08, .5);
	else if (shape < 4)
		put(w, " radius = %.3f,", within(w, .04, .25));
	if (shape == 2 || shape == 3)
		put(w, " length = %.3f,", within(w, .08, .5));
	if (shape == 4)
		put_points(w);
	if (shape == 5)
		put_parts(w);
	put(w, " friction = %.2f, restitution = %.2f,", within(w, 0, 1), within(w, 0, .8));
}

void put_any_body(writer *w)
{
	put_body(w, false);
	put_vector(w, "at", -.5, 2.5);
	put(w, " density = %.0f }\n", within(w, 100, 3000));
}

static void put_place(writer *w, ob_vec3 p)
{
	put(w, " at = { %.3f, %.3f, %.3f },", p.x, p.y, p.z);
}

// A body that a joint holds to the chain's last one, or to the world.
static void put_link(writer *w, things *t, uint32_t i)
{
	char name[16], joint[16];
	const bool first = !*t->last || one_in(w, 5);
	const ob_vec3 at = first ? ob_v3(within(w, -1, 2), within(w, -1, 2), within(w, .5, 2.5))
				 : ob_add(t->at, ob_v3(within(w, -.4, .4), within(w, -.4, .4), within(w, .1, .5)));
	snprintf(name, sizeof name, "t%u", i);
	snprintf(joint, sizeof joint, "j%u", i);
	put_body(w, true);
	put_place(w, at);
	if (one_in(w, 3))
		put_vector(w, "velocity", -3, 3);
	if (one_in(w, 4))
		put(w, " dies = %.3f,", within(w, .3, 4));
	put(w, " name = '%s', density = %.0f }\n", name, within(w, 200, 3000));
	if (!first || one_in(w, 2))
		put_joint(w, name, first ? "" : t->last, ob_scale(ob_add(at, first ? at : t->at), .5), joint);
	strcpy(t->last, name);
	t->at = at;
}

static void put_loose(writer *w, const things *t, bool sensor)
{
	put_body(w, !t->free);
	put_vector(w, "at", -.5, 2.5);
	put_vector(w, "velocity", -3, 3);
	put_vector(w, "spin", -9, 9);
	if (one_in(w, 4) && !t->closed)
		put(w, " born = %.3f,", within(w, .1, 3));
	if (sensor)
		put(w, " sensor = true,");
	if (one_in(w, 6))
		put(w, " group = 1, hits = { 1 },");
	put(w, " density = %.0f }\n", within(w, 100, 3000));
}

static void put_driven(writer *w, things *t, uint32_t i)
{
	put_body(w, false);
	put(w, " kind = 'kinematic', name = 't%u',", i);
	t->at = ob_v3(within(w, -1, 2), within(w, -1, 2), within(w, .2, 2));
	put_place(w, t->at);
	if (one_in(w, 3))
		put(w, " path = { kind = 'sine', amplitude = { %.2f, 0, %.2f }, frequency = %.2f },", within(w, 0, .5),
		    within(w, 0, .3), within(w, .2, 3));
	else
		put_vector(w, "spin", -4, 4);
	if (one_in(w, 3))
		put_vector(w, "surface_velocity", -2, 2);
	put(w, " }\n");
	snprintf(t->last, sizeof t->last, "t%u", i);
}

static void put_field(writer *w, things *t)
{
	put(w, "heightfield { size = { %.1f, %.1f }, cells = { %u, %u },", within(w, 2, 8), within(w, 2, 8),
	    1 + below(w, 12), 1 + below(w, 12));
	put(w, " height = function(x, y) return %.2f * math.sin(%.2f * x + y) + %.2f * math.sin(%.2f * y) end,",
	    within(w, 0, .4), within(w, .5, 5), within(w, 0, .3), within(w, .5, 5));
	put(w, " at = { %.2f, %.2f, %.2f },", within(w, -1, 1), within(w, -1, 1), within(w, -.5, .5));
	if (one_in(w, 3))
		put(w, " rotation = { axis = { 1, -.5, .2 }, degrees = %.1f },", within(w, -20, 20));
	if (one_in(w, 4))
		put(w, " born = %.2f,", within(w, .1, 2));
	if (one_in(w, 4))
		put(w, " dies = %.2f,", within(w, 2.1, 4));
	if (one_in(w, 4))
		put_vector(w, "surface_velocity", -2, 2);
	put(w, " friction = %.2f }\n", within(w, 0, 1));
	t->fields++;
}

static void put_mesh(writer *w, things *t)
{
	put(w, "mesh { file = '%s', scale = %.2f,", write_mesh(w, t), within(w, .3, 1.5));
	put(w, " at = { %.2f, %.2f, %.2f }, friction = %.2f,", within(w, -1, 1), within(w, -1, 1), within(w, -.3, .8),
	    within(w, 0, 1));
	if (one_in(w, 4))
		put(w, " dies = %.2f,", within(w, .5, 4));
	put(w, " }\n");
	t->meshes++;
}

// ---- models of others

static const char *const models[] = { "arm.xml",     "crane.urdf",    "humanoid.xml", "limbs.xml",
				      "springs.xml", "quadruped.xml", "rover.urdf" };
enum { MODELS = sizeof models / sizeof *models };

// The objects and joints of a model, without its call of scene{}; NULL: there is no importer.
static const char *import_model(unsigned i)
{
	static char *text[MODELS];
	char path[400];
	ob_imported made;
	ob_error e;
	if (text[i])
		return text[i];
	snprintf(path, sizeof path, LIFE_MODELS "/%s", models[i]);
	if (!ob_import(path, NULL, &made, &e))
		return NULL;
	const char *after = strstr(made.scene, "\nscene {");
	after = after ? after + 1 : made.scene;
	text[i] = strdup(strncmp(after, "scene {", 7) ? after : after + strcspn(after, "\n"));
	ob_imported_finish(&made);
	return text[i];
}

// ---- scripts

// Joins what it touches, breaks off, drives motors, sees the ground by rays.
static const char joiner[] =
	"script('c', [[\n"
	"function on_start() self.state.n = 0 self:wake(random(.1, .5)) end\n"
	"function on_contact(other)\n"
	"  if other and other:exists() and self.state.n < 4 and random(0, 1) < .3 then\n"
	"    local x, y, z = self:position()\n"
	"    self.state.n = self.state.n + 1\n"
	"    ball { self:name(), other:name(), at = { x, y, z }, name = self:name() .. self.state.n, breaks_at = { "
	"force = 300 } }\n"
	"  end\n"
	"end\n"
	"function on_break(name, force) self:push(0, 0, .2 * self:mass()) end\n"
	"function on_wake()\n"
	"  local x, y, z = self:position()\n"
	"  local hit, far = ray(x, y, z, random(-.3, .3), random(-.3, .3), -1, 5)\n"
	"  if hit then self:force(0, 0, self:mass() * 9.81 * random(0, 1.5)) end\n"
	"  if self.state.n > 0 and random(0, 1) < .4 then unjoin(self:name() .. random(1, 4) // 1) end\n"
	"  for i = 0, 11 do if joint('j' .. i) and random(0, 1) < .2 then motor('j' .. i, random(-4, 4)) end end\n"
	"  for _, o in ipairs(near(.8)) do if random(0, 1) < .1 then o:remove() end end\n"
	"  self:wake(random(.1, .5))\n"
	"end\n"
	"function on_message(from, n) self:twist(random(-.1, .1), random(-.1, .1), 0) end]])\n";

static void put_script(writer *w, things *t, uint32_t i)
{
	static const char name[] = "script('c'";
	if (!strstr(w->to, name))
		put(w, "%s", joiner);
	put_body(w, !t->avatar && one_in(w, 2));
	put(w, " script = 'c', name = 't%u',", i);
	put_vector(w, "at", 0, 2.3);
	if (!t->avatar && one_in(w, 2))
		put(w, " avatar = true,"), t->avatar = true;
	put(w, " density = %.0f }\n", within(w, 100, 2000));
}

// Draws a kind; a free run has loose bodies in place of kinds that it refuses.
static unsigned draw_kind(writer *w, const things *t)
{
	static const unsigned char kinds[] = { 0, 0, 0, 0, 0, 1, 1, 2, 3, 4, 4, 5, 5, 6, 7 };
	const unsigned kind = kinds[below(w, sizeof kinds)];
	if (t->free)
		return kind == 3 && !t->closed ? 3 : 1;
	return kind == 7 && !t->scripts ? 0 : kind;
}

void put_thing(writer *w, things *t, uint32_t i, uint64_t seed)
{
	w->seed = seed;
	const char *text;
	switch (draw_kind(w, t)) {
	case 0:
		put_link(w, t, i);
		break;
	case 1:
	case 2:
		put_loose(w, t, false);
		break;
	case 3:
		put_driven(w, t, i);
		break;
	case 4:
		put_field(w, t);
		break;
	case 5:
		put_mesh(w, t);
		break;
	case 6:
		text = t->model || !one_in(w, 2) ? NULL : import_model(below(w, MODELS));
		if (text)
			put(w, "%s\n", text), t->model = true;
		else
			put_loose(w, t, true);
		break;
	default:
		put_script(w, t, i);
	}
}

// ---- FMUs

typedef struct fmu_model {
	const char *name; // in tests/fmu, for FMI 3
	const char *variable[5]; // "name' causality='..", in the order of their references
} fmu_model;

static const fmu_model fmu_models[] = {
	{ "hover",
	  { "z' causality='input", "vz' causality='input", "mass' causality='input", "height' causality='parameter",
	    "force' causality='output" } },
	{ "van_der_pol",
	  { "time' causality='output", "x0' causality='output", "x1' causality='local", "mu' causality='parameter",
	    "force' causality='output" } },
	{ "bad",
	  { "time' causality='output", "how' causality='parameter", "x' causality='output",
	    "when' causality='parameter", "force' causality='output" } },
};

// Packs a model, unless that has been done.
static void write_fmu(const fmu_model *m)
{
	char path[300], about[2000], library[400], place[100];
	snprintf(path, sizeof path, "%s/%s.fmu", things_folder(), m->name);
	if (access(path, R_OK) == 0)
		return;
	writer w = { .to = about, .size = sizeof about };
	put(&w,
	    "<fmiModelDescription fmiVersion='3.0' modelName='%s' instantiationToken='{obsim}'><CoSimulation "
	    "modelIdentifier='%s' canGetAndSetFMUState='true' canSerializeFMUState='true'/><ModelVariables>",
	    m->name, m->name);
	for (int i = 0; i < 5; i++)
		put(&w, "<Float64 name='%s' valueReference='%d'/>", m->variable[i], i);
	put(&w, "</ModelVariables></fmiModelDescription>");
	snprintf(library, sizeof library, LIFE_FMUS_BUILT "/%s3.so", m->name);
	snprintf(place, sizeof place, "binaries/" LIFE_MACHINE "-linux/%s.so", m->name);
	zip_t *zip = zip_open(path, ZIP_CREATE, NULL);
	if (!zip ||
	    zip_file_add(zip, "modelDescription.xml", zip_source_buffer(zip, about, (size_t)w.used, 0), 0) < 0 ||
	    zip_file_add(zip, place, zip_source_file(zip, library, 0, -1), 0) < 0 || zip_close(zip) != 0)
		abort();
}

void put_fmu(writer *w, uint64_t seed)
{
	static const unsigned char faults[] = { 0, 2, 3, 4, 5, 6 }; // in bad.c; 1 hangs
	w->seed = seed;
	const fmu_model *m = &fmu_models[below(w, 3)];
	write_fmu(m);
	put_body(w, false);
	put_vector(w, "at", -.5, 2.5);
	put(w, " density = %.0f, fmu = '%s.fmu', outputs = { force = '%s.%c' },", within(w, 100, 3000), m->name,
	    one_in(w, 4) ? "torque" : "force", 'x' + (int)below(w, 3));
	if (m == &fmu_models[0])
		put(w,
		    " inputs = { z = 'position.z', vz = 'velocity.z', mass = 'mass' }, parameters = { height = %.2f }",
		    within(w, .5, 3));
	else if (m == &fmu_models[1])
		put(w, " parameters = { mu = %.2f }", within(w, 0, 3));
	else
		put(w, " parameters = { how = %u, when = %.2f }", faults[below(w, sizeof faults)], within(w, 0, 5));
	put(w, " }\n");
}
