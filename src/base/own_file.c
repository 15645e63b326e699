#include "base/own_file.h"

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

// The root of the build tree is the nearest folder above the program in which ninja works.
bool ob_own_file_find(char path[PATH_MAX], const char *installed, const char *built, const char *name)
{
	char folder[PATH_MAX];
	ssize_t n = readlink("/proc/self/exe", folder, sizeof folder - 1);
	if (n <= 0)
		return false;
	folder[n] = '\0';
	climb(folder);
	if (is_there(path, folder, ".", name) || is_there(path, folder, installed, name))
		return true;
	do {
		if (is_there(path, folder, ".", "build.ninja"))
			return is_there(path, folder, built, name);
	} while (climb(folder));
	return false;
}
