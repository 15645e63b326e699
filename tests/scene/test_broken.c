// Every scene in broken/ fails with one line that names the file and the line, and says what its first line expects:
// "-- expect: <part of the message>". argv[1]: the folder.
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"
#include "check.h"

static void read_expectation(const char *path, char *out, int size)
{
	FILE *f = fopen(path, "r");
	out[0] = 0;
	if (f && fgets(out, size, f))
		out[strcspn(out, "\n")] = 0;
	if (f)
		fclose(f);
}

static void check_message(const char *path, const char *expected, const char *text)
{
	static const char mark[] = "-- expect: ";
	size_t n = strlen(path);
	char *end;
	bool good = strncmp(expected, mark, sizeof mark - 1) == 0 && strstr(text, expected + sizeof mark - 1);
	CHECK(good);
	if (!good)
		fprintf(stderr, "  %s\n  expected %s\n  got %s\n", path, expected, text);
	CHECK(strncmp(text, path, n) == 0 && text[n] == ':');
	long line = strtol(text + n + 1, &end, 10);
	CHECK(line >= 1 && strncmp(end, ": ", 2) == 0);
	CHECK(strlen(text) < 400);
	for (const char *c = text; *c; c++)
		CHECK((unsigned char)*c >= ' ');
}

static void check_file(const char *path)
{
	char expected[400];
	ob_error e = { "" };
	read_expectation(path, expected, sizeof expected);
	ob_scene *s = ob_scene_load(path, NULL, &e);
	CHECK(!s);
	if (s)
		fprintf(stderr, "  %s loads\n", path);
	check_message(path, expected, e.text);
	ob_scene_free(s);
}

int main(int argc, char **argv)
{
	DIR *d = argc > 1 ? opendir(argv[1]) : NULL;
	int files = 0;
	for (struct dirent *entry; d && (entry = readdir(d));) {
		char path[1024];
		if (!strstr(entry->d_name, ".lua"))
			continue;
		snprintf(path, sizeof path, "%s/%s", argv[1], entry->d_name);
		check_file(path);
		files++;
	}
	if (d)
		closedir(d);
	CHECK(files >= 90);
	return check_end();
}
