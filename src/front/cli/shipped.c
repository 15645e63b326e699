#include "cli/shipped.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/own_file.h"

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

bool ob_shipped_folder(char path[PATH_MAX])
{
	if (!ob_own_file_find(path, OB_SCENES_FROM_PROGRAM, OB_SCENES_FROM_BUILD, "falling_boxes.lua"))
		return false;
	*strrchr(path, '/') = 0;
	return true;
}
