#include "import/load.h"

#include <errno.h>
#include <libgen.h>
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/utf8.h"

enum { FILE_MOST = 64 << 20 };

// MuJoCo's own handler writes a log into the working folder and ends the program.
static jmp_buf back;
static char complaint[400];

static _Noreturn void complain(const char *text)
{
	snprintf(complaint, sizeof complaint, "%s", text);
	longjmp(back, 1);
}

static void ignore(const char *text)
{
	(void)text;
}

// Text that grows.
typedef struct text {
	char *at;
	size_t size;
} text;

static text read_text(const char *path, ob_error *e)
{
	text t = { NULL, 0 };
	FILE *f = fopen(path, "rb"), *to = f ? open_memstream(&t.at, &t.size) : NULL;
	char part[4096];
	size_t n;
	if (!f || !to) {
		ob_fail(e, "%s: %s", path, strerror(errno));
	} else {
		while ((n = fread(part, 1, sizeof part, f)) > 0 && ftell(f) <= FILE_MOST)
			fwrite(part, 1, n, to);
	}
	if (f)
		fclose(f);
	if (to)
		fclose(to);
	return t;
}

// A file on its way to the parser, without what MuJoCo refuses and others read.
typedef struct source {
	const char *path; // absolute
	text t;
	FILE *omitted; // lines of what is left out; NULL: nobody reads them
	bool balanced, bounded; // moments that no body can have, and missing masses, are replaced
} source;

static void leave_out(const source *u, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void leave_out(const source *u, const char *format, ...)
{
	char line[500];
	va_list args;
	va_start(args, format);
	vsnprintf(line, sizeof line, format, args);
	va_end(args);
	ob_utf8_make_plain(line);
	if (u->omitted)
		fprintf(u->omitted, "%s\n", line);
}

// Replaces the characters first .. end-1.
static bool replace(source *u, size_t first, size_t end, const char *by)
{
	text made = { NULL, 0 };
	FILE *to = open_memstream(&made.at, &made.size);
	if (!to)
		return false;
	fwrite(u->t.at, 1, first, to);
	fputs(by, to);
	fputs(u->t.at + end, to);
	if (fclose(to) != 0)
		return false;
	free(u->t.at);
	u->t = made;
	return true;
}

// A value within quotation marks.
typedef struct attribute {
	size_t first, end; // in the text
} attribute;

// Finds the next file name of a mesh.
static bool next_mesh(const source *u, size_t from, attribute *out)
{
	static const char key[] = "filename=", tag[] = "<mesh";
	for (const char *at = u->t.at + from; (at = strstr(at, tag));) {
		at += sizeof tag - 1;
		const char *name = strstr(at, key), *close = strchr(at, '>');
		if (!name || !close || name > close)
			continue;
		name += sizeof key - 1;
		const char *last = *name ? strchr(name + 1, *name) : NULL;
		if (!last)
			return false;
		*out = (attribute){ (size_t)(name + 1 - u->t.at), (size_t)(last - u->t.at) };
		return true;
	}
	return false;
}

// Finds the file of package://NAME/REST: a folder above the model's holds NAME/REST, or REST.
static bool find_file(const char *path, const char *name, char *out, size_t room)
{
	static const char scheme[] = "package://", local[] = "file://";
	char folder[4096];
	snprintf(folder, sizeof folder, "%s", path);
	char *above = dirname(folder);
	if (strncmp(name, scheme, sizeof scheme - 1) != 0) {
		const char *plain = strncmp(name, local, sizeof local - 1) == 0 ? name + sizeof local - 1 : name;
		snprintf(out, room, "%s%s%s", *plain == '/' ? "" : above, *plain == '/' ? "" : "/", plain);
		return access(out, R_OK) == 0;
	}
	const char *whole = name + sizeof scheme - 1, *inside = strchr(whole, '/');
	for (;; above = dirname(above)) {
		const bool top = strcmp(above, "/") == 0;
		for (int i = 0; i < 2; i++) {
			snprintf(out, room, "%s/%s", top ? "" : above, i == 0 || !inside ? whole : inside + 1);
			if (access(out, R_OK) == 0)
				return true;
		}
		if (top)
			return false;
	}
}

// True if MuJoCo reads files of this kind.
static bool is_mesh_file(const char *name)
{
	static const char *const kinds[] = { ".stl", ".obj", ".msh" };
	const char *end = strrchr(name, '.');
	bool found = false;
	for (size_t i = 0; end && i < sizeof kinds / sizeof *kinds; i++)
		found |= strcasecmp(end, kinds[i]) == 0;
	return found;
}

// Start of the last <tag before a place; NULL: none.
static char *last_before(const source *u, size_t place, const char *tag)
{
	char *found = NULL;
	for (char *at = u->t.at; (at = strstr(at, tag)) && at < u->t.at + place; at++)
		found = at;
	return found;
}

// Removes the look or the solid with the mesh. Returns the place in the text from which to go on; 0: it cannot.
static size_t drop_mesh(source *u, const attribute *mesh, const char *why)
{
	char *look = last_before(u, mesh->first, "<visual"), *solid = last_before(u, mesh->first, "<collision");
	const bool is_look = look && (!solid || look > solid);
	char *first = is_look ? look : solid;
	const char *tag = is_look ? "</visual>" : "</collision>",
		   *end = first ? strstr(u->t.at + mesh->end, tag) : NULL;
	if (!end)
		return 0;
	const size_t from = (size_t)(first - u->t.at);
	leave_out(u, "%s %.*s is left out: %s", is_look ? "look" : "mesh", (int)(mesh->end - mesh->first),
		  u->t.at + mesh->first, why);
	return replace(u, from, (size_t)(end - u->t.at) + strlen(tag), "") ? from + 1 : 0;
}

// Writes the places of meshes for their names, and drops those that MuJoCo cannot read.
static void place_meshes(source *u)
{
	attribute mesh;
	for (size_t at = 0; next_mesh(u, at, &mesh);) {
		char name[4096], file[8300];
		snprintf(name, sizeof name, "%.*s", (int)(mesh.end - mesh.first), u->t.at + mesh.first);
		const bool there = find_file(u->path, name, file, sizeof file);
		if (there && is_mesh_file(name)) {
			at = replace(u, mesh.first, mesh.end, file) ? mesh.first : mesh.end;
			continue;
		}
		at = drop_mesh(u, &mesh,
			       there ? "MuJoCo reads STL, OBJ and MSH files"
				     : "no file of this name is beside the model");
		if (!at)
			return;
	}
}

// Options for MuJoCo, which would weld its root to the world, fuse what is fixed to each other, drop looks, and the folders
// of meshes.
static void set_options(source *u)
{
	static const char options[] =
		"<mujoco><compiler fusestatic=\"false\" strippath=\"false\" discardvisual=\"false\"/>"
		"</mujoco>";
	const char *tag = strstr(u->t.at, "<robot"), *body = tag ? strchr(tag, '>') : NULL;
	if (body && body[-1] != '/' && !strstr(u->t.at, "<mujoco"))
		replace(u, (size_t)(body + 1 - u->t.at), (size_t)(body + 1 - u->t.at), options);
}

// Removes all looks, which may be large.
static void drop_looks(source *u)
{
	static const char open[] = "<visual", close[] = "</visual>";
	int n = 0;
	for (size_t from = 0;; n++) {
		const char *at = strstr(u->t.at + from, open), *end = at ? strstr(at, close) : NULL;
		if (!end)
			break;
		from = (size_t)(at - u->t.at);
		if (!replace(u, from, (size_t)(end - u->t.at) + sizeof close - 1, ""))
			break;
	}
	if (n)
		leave_out(u, "%d looks are left out: --out DIR writes them", n);
}

static void list_mimics(const source *u)
{
	int n = 0;
	for (const char *at = u->t.at; (at = strstr(at, "<mimic")); at++)
		n++;
	if (n)
		leave_out(u, "%d mimic joints move by themselves", n);
}

// Adds an attribute to the compiler's options.
static bool add_option(source *u, const char *option)
{
	static const char compiler[] = "<compiler";
	const char *at = strstr(u->t.at, compiler);
	const size_t place = at ? (size_t)(at - u->t.at) + sizeof compiler - 1 : 0;
	return at && replace(u, place, place, option);
}

// Changes a part of a URDF file that MuJoCo refuses, by its message. false: nothing is left to change.
static bool mend_urdf(source *u, const char *why)
{
	static const char named[] = "Object name = ";
	const char *object = strstr(why, named);
	attribute mesh, last = { 0, 0 };
	if (strstr(why, "balanceinertia") && !u->balanced) {
		u->balanced = true;
		leave_out(u, "moments that no body can have are replaced by their mean");
		return add_option(u, " balanceinertia=\"true\"");
	}
	if (strstr(why, "mjMINVAL") && !u->bounded) {
		u->bounded = true;
		leave_out(u, "bodies have at least 1e-6 kg and 1e-9 kg m^2: some that move have none");
		return add_option(u, " boundmass=\"1e-6\" boundinertia=\"1e-9\"");
	}
	for (size_t from = 0; next_mesh(u, from, &mesh); from = mesh.end) {
		char name[4096];
		snprintf(name, sizeof name, "%.*s", (int)(mesh.end - mesh.first), u->t.at + mesh.first);
		if (strstr(why, name))
			return drop_mesh(u, &mesh, "MuJoCo cannot read it");
		// Meshes have the names of their files, and a number if their scales differ.
		char *stem = basename(name), *dot = strrchr(stem, '.');
		if (dot)
			*dot = 0;
		const char *end = object ? object + sizeof named - 1 + strlen(stem) : NULL;
		if (end && strncmp(object + sizeof named - 1, stem, strlen(stem)) == 0 && strchr("0123456789,", *end))
			last = mesh;
	}
	return last.end && drop_mesh(u, &last, "MuJoCo refuses it");
}

// ---- MJCF

// True for characters between attributes.
static bool is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// Removes the attribute wherever it is. Returns how often.
static int drop_attribute(source *u, const char *name)
{
	const size_t length = strlen(name);
	int n = 0;
	for (size_t from = 1; from < u->t.size;) {
		const char *at = strstr(u->t.at + from, name), *value = at ? at + length : NULL;
		if (!at)
			break;
		from = (size_t)(at - u->t.at) + 1;
		value += strspn(value, " ");
		const char *open = *value == '=' ? value + 1 + strspn(value + 1, " ") : NULL;
		const char *close = open && (*open == '"' || *open == '\'') ? strchr(open + 1, *open) : NULL;
		if (close && is_space(at[-1]) && replace(u, from - 1, (size_t)(close + 1 - u->t.at), ""))
			n++;
	}
	return n;
}

// Removes elements of this name, with all in them. Returns how many.
static int drop_element(source *u, const char *name)
{
	char tag[100], close[100];
	int n = 0;
	snprintf(tag, sizeof tag, "<%s", name);
	snprintf(close, sizeof close, "</%s>", name);
	for (size_t from = 0; from < u->t.size;) {
		const char *at = strstr(u->t.at + from, tag), *end = at ? strchr(at, '>') : NULL;
		if (!end)
			break;
		from = (size_t)(at - u->t.at) + 1;
		if (!is_space(at[strlen(tag)]) && !strchr("/>", at[strlen(tag)]))
			continue;
		if (end[-1] != '/') {
			end = strstr(end, close);
			end = end ? strchr(end, '>') : NULL;
		}
		if (end && replace(u, from - 1, (size_t)(end + 1 - u->t.at), ""))
			n++, from--;
	}
	return n;
}

// Adds a section at the beginning of MuJoCo's part.
static bool add_section(source *u, const char *section)
{
	const char *root = strstr(u->t.at, "<mujoco"), *end = root ? strchr(root, '>') : NULL;
	return end && end[-1] != '/' && replace(u, (size_t)(end + 1 - u->t.at), (size_t)(end + 1 - u->t.at), section);
}

// Sets the size of MuJoCo's stack, in numbers. By itself it grows with the square of the bodies, and then overflows.
static void set_stack(source *u)
{
	drop_attribute(u, "nstack");
	add_section(u, "<size nstack=\"40000000\"/>");
}

// Drops an element or an attribute that a newer MuJoCo reads, by the parser's message.
static bool mend_mjcf(source *u, const char *why)
{
	static const char foreign[] = "unrecognized attribute: '", element[] = "unrecognized element";
	const char *at = strstr(why, foreign), *of = strstr(why, "Element '");
	const char *name = at ? at + sizeof foreign - 1 : strstr(why, element) && of ? of + strlen("Element '") : NULL;
	char word[64];
	if (!name)
		return false;
	snprintf(word, sizeof word, "%.*s", (int)strcspn(name, "'"), name);
	const int n = !*word ? 0 : at ? drop_attribute(u, word) : drop_element(u, word);
	if (n)
		leave_out(u, "%s %s is left out, %d times: MuJoCo 2.2 has none", at ? "attribute" : "element", word, n);
	if (n && !u->bounded && !strstr(u->t.at, "autolimits")) {
		// Since MuJoCo 3 a range is a limit.
		u->bounded = true;
		return add_section(u, "<compiler autolimits=\"true\"/>");
	}
	return n > 0;
}

// True if the robot stands: it has a link called world.
static bool has_world(const char *urdf)
{
	for (const char *at = urdf; (at = strstr(at, "<link"));) {
		at += strlen("<link");
		const char *end = strchr(at, '>'), *name = strstr(at, "name=");
		if (name && end && name < end && strncmp(name + strlen("name=") + 1, "world", 5) == 0 &&
		    strchr("\"'", name[11]))
			return true;
	}
	return false;
}

// Loads the text in place of the file, which still says where other files are.
static mjModel *load_text(const char *path, const text *t, char *why, int room)
{
	mjVFS *files = malloc(sizeof *files);
	mjModel *m = NULL;
	char name[4096];
	snprintf(name, sizeof name, "%s", path);
	if (!files)
		return NULL;
	mj_defaultVFS(files);
	if (mj_makeEmptyFileVFS(files, basename(name), (int)t->size) == 0) {
		memcpy(files->filedata[0], t->at, t->size);
		m = mj_loadXML(path, files, why, room);
	}
	mj_deleteVFS(files);
	free(files);
	return m;
}

// Turns MuJoCo's message into a part of a line.
static void shorten(char *why)
{
	for (char *c = why; *c; c++)
		if (*c == '\n' || *c == '\r')
			*c = ' ';
	size_t n = strlen(why);
	while (n && why[n - 1] == ' ')
		why[--n] = 0;
}

// Loads a file, without the parts that MuJoCo refuses, one after the other.
static mjModel *load_source(source *u, bool (*mend)(source *, const char *), char *why, int room)
{
	enum { MOST_ROUNDS = 200 };
	mjModel *m = NULL;
	for (int round = 0; round < MOST_ROUNDS && !m; round++) {
		m = load_text(u->path, &u->t, why, room);
		shorten(why);
		if (!m && !mend(u, why))
			return NULL;
	}
	return m;
}

// ---- masses

// Adds the tensor of inertia of a body about a place to t (kg m^2), all in the world's frame.
static void add_tensor(const ob_drawn *d, int body, const double at[3], double t[9])
{
	const double *r = d->data->ximat + 9 * body, *i = d->model->body_inertia + 3 * body;
	double off[3];
	mju_sub3(off, d->data->xipos + 3 * body, at);
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++) {
			double sum = (a == b ? mju_dot3(off, off) : 0) - off[a] * off[b];
			sum *= d->model->body_mass[body];
			for (int c = 0; c < 3; c++)
				sum += r[3 * a + c] * i[c] * r[3 * b + c];
			t[3 * a + b] += sum;
		}
}

// Gives the mass and the moments of a body that is fixed to its parent to that.
static void give_to_parent(ob_drawn *d, int body)
{
	mjModel *m = d->model;
	const int parent = m->body_parentid[body];
	const double own = m->body_mass[body], all = own + m->body_mass[parent];
	double at[3], off[3], t[9] = { 0 }, axes[9], turn[4], inverse[4];
	for (int c = 0; c < 3; c++)
		at[c] = (own * d->data->xipos[3 * body + c] + (all - own) * d->data->xipos[3 * parent + c]) / all;
	add_tensor(d, body, at, t);
	add_tensor(d, parent, at, t);
	mju_eig3(m->body_inertia + 3 * parent, axes, turn, t);
	mju_negQuat(inverse, d->data->xquat + 4 * parent);
	mju_mulQuat(m->body_iquat + 4 * parent, inverse, turn);
	mju_sub3(off, at, d->data->xpos + 3 * parent);
	mju_rotVecMatT(m->body_ipos + 3 * parent, off, d->data->xmat + 9 * parent);
	m->body_mass[parent] = all;
	m->body_mass[body] = 0;
	mju_zero3(m->body_inertia + 3 * body);
	m->body_sameframe[parent] = 0;
	m->body_simple[parent] = 0;
}

bool ob_drawn_has_mass(const mjModel *m, int body)
{
	const double *i = m->body_inertia + 3 * body;
	return m->body_mass[body] >= 1e-12 && i[0] > 0 && i[1] > 0 && i[2] > 0;
}

int ob_drawn_holder(const mjModel *m, int body)
{
	while (body > 0 && !ob_drawn_has_mass(m, body) && !m->body_jntnum[body])
		body = m->body_parentid[body];
	return body;
}

// Points with a mass, and moments without one, belong to the bodies that they are fixed to.
static void spread_masses(ob_drawn *d)
{
	mjModel *m = d->model;
	bool spread = false;
	for (int body = m->nbody - 1; body > 0; body--)
		if (!m->body_jntnum[body] && m->body_parentid[body] > 0 && !ob_drawn_has_mass(m, body) &&
		    (m->body_mass[body] > 0 || m->body_inertia[3 * body] > 0) &&
		    m->body_mass[m->body_parentid[body]] > 0) {
			give_to_parent(d, body);
			mj_kinematics(m, d->data);
			spread = true;
		}
	if (spread) {
		mj_setConst(m, d->data);
		mj_resetData(m, d->data); // it leaves springs at rest
	}
}

static bool load(const char *path, bool looks, FILE *omitted, ob_drawn *out, ob_error *e)
{
	static char why[800], whole[PATH_MAX];
	*out = (ob_drawn){ NULL, NULL, false };
	mju_user_error = complain;
	mju_user_warning = ignore;
	source u = { .path = realpath(path, whole) ? whole : path, .t = read_text(path, e), .omitted = omitted };
	if (!u.t.at)
		return false;
	const bool urdf = strstr(u.t.at, "<robot");
	if (urdf) {
		out->floats = !has_world(u.t.at);
		set_options(&u);
		if (!looks)
			drop_looks(&u);
		place_meshes(&u);
		list_mimics(&u);
	}
	set_stack(&u);
	out->model = load_source(&u, urdf ? mend_urdf : mend_mjcf, why, sizeof why);
	free(u.t.at);
	if (!out->model)
		return ob_fail(e, "%s: %s", path, *why ? why : "MuJoCo cannot load it");
	out->data = mj_makeData(out->model);
	if (!out->data)
		return ob_fail(e, "%s: out of memory", path);
	mj_kinematics(out->model, out->data);
	spread_masses(out);
	mj_kinematics(out->model, out->data);
	mj_comPos(out->model, out->data);
	return true;
}

// Memory that MuJoCo holds when it complains is lost; the process ends soon.
bool ob_drawn_load(const char *path, bool looks, FILE *omitted, ob_drawn *out, ob_error *e)
{
	if (setjmp(back) == 0)
		return load(path, looks, omitted, out, e);
	shorten(complaint);
	return ob_fail(e, "%s: MuJoCo: %s", path, complaint);
}
