#include "cli/shipped.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/own_file.h"

const char *ob_shipped_find(const char *name)
{
	static char path[PATH_MAX];
	char file[NAME_MAX];
	struct stat there;
	if (!name || strchr(name, '/') || (stat(name, &there) == 0 && !S_ISDIR(there.st_mode)) ||
	    snprintf(file, sizeof file, "%s.lua", name) >= (int)sizeof file)
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
