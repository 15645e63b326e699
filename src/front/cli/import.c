// obsim import: a scene from a model that others have drawn.
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "import/import.h"
#include "scene/scene.h"

// Prints each line of the text after a prefix.
static void print_lines(FILE *f, const char *prefix, const char *text)
{
	while (*text) {
		const size_t n = strcspn(text, "\n");
		fprintf(f, "%s%.*s\n", prefix, (int)n, text);
		text += n + (text[n] == '\n');
	}
}

static const char *file_of(const char *path)
{
	return strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
}

static void print_scene(FILE *f, const char *path, const ob_imported *i)
{
	fprintf(f, "-- Made by obsim import from %s.\n", file_of(path));
	print_lines(f, "-- ", i->omitted);
	fputs(i->scene, f);
}

// Returns the file of the scene, which has the model's name. folder: NULL, or where it is written.
static void name_scene(const char *folder, const char *path, char out[PATH_MAX])
{
	const char *name = file_of(path), *dot = strrchr(name, '.');
	snprintf(out, PATH_MAX, "%s%s%.*s.lua", folder ? folder : "", folder ? "/" : "",
		 (int)(dot ? (size_t)(dot - name) : strlen(name)), name);
}

// Reads the scene as obsim run will. false and e: a number of the model is one that no scene may have.
static bool read_back(const char *path, const char *file, const char *text, size_t size, ob_error *e)
{
	ob_error why;
	ob_scene *scene = ob_scene_load_text(file, text, size, NULL, &why);
	const bool fine = scene || ob_fail(e, "%s makes no scene: %s", path, why.text);
	ob_scene_free(scene);
	return fine;
}

static bool write_scene(const char *file, const char *text, size_t size, ob_error *e)
{
	FILE *f = fopen(file, "w");
	if (!f)
		return ob_fail(e, "%s: %s", file, strerror(errno));
	const bool whole = fwrite(text, 1, size, f) == size;
	return (fclose(f) == 0 && whole) || ob_fail(e, "%s: %s", file, strerror(errno));
}

int ob_command_import(const ob_arguments *a)
{
	const char *folder = a->value[OB_OPTION_OUT], *path = a->operand;
	char file[PATH_MAX], *text = NULL;
	size_t size = 0;
	ob_imported i;
	ob_error e;
	if (!path)
		return ob_command_fail(OB_EXIT_USAGE, "import needs a model: obsim import ROBOT.xml > robot.lua");
	if (!ob_import(path, folder, &i, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	name_scene(folder, path, file);
	FILE *f = open_memstream(&text, &size);
	if (f)
		print_scene(f, path, &i);
	int code = OB_EXIT_OK;
	if (!f || fclose(f) != 0)
		code = ob_command_fail(OB_EXIT_FAILED, "no memory for the scene");
	else if (!read_back(path, file, text, size, &e))
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	else if (!folder)
		fwrite(text, 1, size, stdout);
	else if (!write_scene(file, text, size, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	if (code == OB_EXIT_OK)
		print_lines(stderr, "obsim: ", i.omitted);
	free(text);
	ob_imported_finish(&i);
	return code;
}
