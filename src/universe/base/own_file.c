#include "base/own_file.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Cuts the last name off a path; false at the root.
static bool climb(char *path)
{
	char *slash = strrchr(path, '/');
	if (!slash || slash == path)
		return false;
	*slash = '\0';
	return true;
}

static bool is_there(char *path, const char *folder, const char *below, const char *name)
{
	char way[PATH_MAX]; // may lead up and down again
	return snprintf(way, sizeof way, "%s/%s/%s", folder, below, name) < PATH_MAX && realpath(way, path);
}

// Folder of the program; for code that a library brought, where the program of that library lies: beside it, or as installed.
static bool find_folder(char folder[PATH_MAX])
{
	char way[PATH_MAX], program[PATH_MAX];
	Dl_info here;
	ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
	if (n <= 0)
		return false;
	program[n] = '\0';
	if (!dladdr(&find_folder, &here) || !here.dli_fname || !strstr(here.dli_fname, ".so") ||
	    !realpath(here.dli_fname, way))
		return climb(strcpy(folder, program));
	climb(way);
	if (is_there(folder, way, ".", "obsim") || is_there(folder, way, OB_PROGRAM_FROM_PARTS, "obsim") ||
	    is_there(folder, way, OB_PROGRAM_FROM_LIBRARIES, "obsim"))
		return climb(folder);
	return strcpy(folder, way);
}

// The root of the build tree is the nearest folder above the program in which ninja works.
bool ob_own_file_find(char path[PATH_MAX], const char *installed, const char *built, const char *name)
{
	char folder[PATH_MAX];
	if (!find_folder(folder))
		return false;
	if (is_there(path, folder, ".", name) || is_there(path, folder, installed, name))
		return true;
	do {
		if (is_there(path, folder, ".", "build.ninja"))
			return is_there(path, folder, built, name);
	} while (climb(folder));
	return false;
}
