#include "import/load.h"

#include <errno.h>
#include <libgen.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

// Writes a name of a mesh: package://NAME/REST becomes a path if a folder above the file holds NAME/REST, or REST.
static void write_mesh_path(const char *path, const char *name, size_t length, FILE *to)
{
	static const char scheme[] = "package://";
	char rest[4096], folder[4096], found[8300];
	snprintf(rest, sizeof rest, "%.*s", (int)length, name);
	if (strncmp(rest, scheme, sizeof scheme - 1) != 0) {
		fwrite(name, 1, length, to);
		return;
	}
	const char *whole = rest + sizeof scheme - 1, *inside = strchr(whole, '/');
	snprintf(folder, sizeof folder, "%s", path);
	for (char *above = dirname(folder);; above = dirname(above)) {
		for (int i = 0; i < 2; i++) {
			snprintf(found, sizeof found, "%s/%s", above, i == 0 || !inside ? whole : inside + 1);
			if (access(found, R_OK) == 0) {
				fputs(found, to);
				return;
			}
		}
		if (strcmp(above, "/") == 0 || strcmp(above, ".") == 0)
			break;
	}
	fputs(whole, to);
}

// Prepares a URDF file. MuJoCo would weld its root to the world, fuse what is fixed to each other, and drop the folders of
// its meshes.
static text prepare_urdf(const char *path, const text *from)
{
	static const char options[] = "<mujoco><compiler fusestatic=\"false\" strippath=\"false\"/></mujoco>";
	static const char mesh[] = "filename=\"";
	text t = { NULL, 0 };
	FILE *to = open_memstream(&t.at, &t.size);
	const char *at = from->at, *tag = strstr(at, "<robot"), *body = tag ? strchr(tag, '>') : NULL;
	if (!to)
		return t;
	if (body && body[-1] != '/' && !strstr(at, "<mujoco")) {
		fwrite(at, 1, (size_t)(body + 1 - at), to);
		fputs(options, to);
		at = body + 1;
	}
	for (const char *name; (name = strstr(at, mesh));) {
		name += sizeof mesh - 1;
		const size_t length = strcspn(name, "\"");
		fwrite(at, 1, (size_t)(name - at), to);
		write_mesh_path(path, name, length, to);
		at = name + length;
	}
	fputs(at, to);
	fclose(to);
	return t;
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

static bool load(const char *path, ob_drawn *out, ob_error *e)
{
	char why[800] = "";
	*out = (ob_drawn){ NULL, NULL, false };
	mju_user_error = complain;
	mju_user_warning = ignore;
	text t = read_text(path, e);
	if (!t.at)
		return false;
	const bool urdf = strstr(t.at, "<robot");
	if (urdf) {
		out->floats = !has_world(t.at);
		const text made = prepare_urdf(path, &t);
		free(t.at);
		t = made;
	}
	if (t.at)
		out->model = load_text(path, &t, why, sizeof why);
	free(t.at);
	shorten(why);
	if (!out->model)
		return ob_fail(e, "%s: %s", path, *why ? why : "MuJoCo cannot load it");
	out->data = mj_makeData(out->model);
	if (!out->data)
		return ob_fail(e, "%s: out of memory", path);
	mj_kinematics(out->model, out->data);
	mj_comPos(out->model, out->data);
	return true;
}

// Memory that MuJoCo holds when it complains is lost; the process ends soon.
bool ob_drawn_load(const char *path, ob_drawn *out, ob_error *e)
{
	if (setjmp(back) == 0)
		return load(path, out, e);
	shorten(complaint);
	return ob_fail(e, "%s: MuJoCo: %s", path, complaint);
}
