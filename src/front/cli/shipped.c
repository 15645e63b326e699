#include "cli/shipped.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "cli/command.h"
#include "scene/scene.h"

const char *ob_shipped_find(const char *name)
{
	static _Thread_local char path[PATH_MAX];
	static const char folder[] = "scenes/", cases[] = "lab/", ending[] = ".lua"; // as documents write a name
	char file[NAME_MAX];
	struct stat there;
	if (!name || (stat(name, &there) == 0 && !S_ISDIR(there.st_mode)))
		return name;
	const bool whole = strncmp(name, folder, sizeof folder - 1) == 0;
	const char *own = whole ? name + sizeof folder - 1 : name;
	const char *base = strncmp(own, cases, sizeof cases - 1) == 0 ? own + sizeof cases - 1 : own;
	if (strchr(base, '/') || snprintf(file, sizeof file, "%s%s", own, whole ? "" : ending) >= (int)sizeof file)
		return name;
	return ob_own_file_find(path, OB_SCENES_FROM_PROGRAM, OB_SCENES_FROM_BUILD, file) ? path : name;
}

// Finds their folder. false: it is not beside the program.
static bool find_folder(char path[PATH_MAX])
{
	if (!ob_own_file_find(path, OB_SCENES_FROM_PROGRAM, OB_SCENES_FROM_BUILD, "falling_boxes.lua"))
		return false;
	*strrchr(path, '/') = 0;
	return true;
}

// ---- scenes

static int is_scene(const struct dirent *entry)
{
	const char *dot = strrchr(entry->d_name, '.');
	return dot && strcmp(dot, ".lua") == 0;
}

// Prints the name and the title of a scene. false and e: it cannot be read.
static bool print_title(const char *folder, const char *file, ob_error *e)
{
	char path[PATH_MAX];
	if (snprintf(path, sizeof path, "%s/%s", folder, file) >= (int)sizeof path)
		return ob_fail(e, "%s/%s: this path is too long", folder, file);
	ob_scene *scene = ob_scene_load(path, NULL, e);
	if (scene)
		printf("%-16.*s %s\n", (int)(strlen(file) - strlen(".lua")), file, scene->title);
	ob_scene_free(scene);
	return scene != NULL;
}

int ob_command_scenes(const ob_arguments *a)
{
	char folder[PATH_MAX];
	struct dirent **files;
	ob_error e;
	int code = OB_EXIT_OK;
	if (a->operand)
		return ob_command_fail(OB_EXIT_USAGE, "scenes lists all that come with obsim: it takes no name");
	if (!find_folder(folder))
		return ob_command_fail(OB_EXIT_FAILED, "the folder share/obsim/scenes is not beside this program");
	const int n = scandir(folder, &files, is_scene, alphasort);
	for (int i = 0; i < n; i++) {
		if (!print_title(folder, files[i]->d_name, &e))
			code = ob_command_fail(OB_EXIT_FAILED, e.text);
		free(files[i]);
	}
	if (n >= 0)
		free(files);
	return code;
}
