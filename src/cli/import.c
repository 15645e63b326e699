// obsim import: a scene from a model that others have drawn.
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "cli/command.h"
#include "import/import.h"

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

// Writes the scene into a file of the folder, by the name of the model.
static bool write_scene(const char *folder, const char *path, const ob_imported *i, ob_error *e)
{
	char to[PATH_MAX];
	const char *name = file_of(path), *dot = strrchr(name, '.');
	snprintf(to, sizeof to, "%s/%.*s.lua", folder, (int)(dot ? (size_t)(dot - name) : strlen(name)), name);
	FILE *f = fopen(to, "w");
	if (!f)
		return ob_fail(e, "%s: %s", to, strerror(errno));
	print_scene(f, path, i);
	const bool whole = !ferror(f);
	return (fclose(f) == 0 && whole) || ob_fail(e, "%s: %s", to, strerror(errno));
}

int ob_command_import(const ob_arguments *a)
{
	ob_imported i;
	ob_error e;
	if (!a->operand)
		return ob_command_fail(OB_EXIT_USAGE, "import needs a model: obsim import ROBOT.xml > robot.lua");
	if (!ob_import(a->operand, a->value[OB_OPTION_OUT], &i, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	const char *folder = a->value[OB_OPTION_OUT];
	int code = OB_EXIT_OK;
	if (!folder)
		print_scene(stdout, a->operand, &i);
	else if (!write_scene(folder, a->operand, &i, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	print_lines(stderr, "obsim: ", i.omitted);
	ob_imported_finish(&i);
	return code;
}
