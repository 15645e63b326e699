#include "cli/output.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static const struct {
	const char *end;
	ob_output kind;
} ends[] = {
	{ ".h5", OB_OUTPUT_RECORD },   { ".hdf5", OB_OUTPUT_RECORD }, { ".mp4", OB_OUTPUT_VIDEO },
	{ ".webm", OB_OUTPUT_VIDEO },  { ".mkv", OB_OUTPUT_VIDEO },   { ".mov", OB_OUTPUT_VIDEO },
	{ ".avi", OB_OUTPUT_VIDEO },   { ".gif", OB_OUTPUT_VIDEO },   { ".webp", OB_OUTPUT_VIDEO },
	{ ".png", OB_OUTPUT_PICTURE }, { ".jpg", OB_OUTPUT_PICTURE }, { ".jpeg", OB_OUTPUT_PICTURE },
	{ ".json", OB_OUTPUT_JSON },   { ".csv", OB_OUTPUT_CSV },     { ".html", OB_OUTPUT_PAGE },
	{ ".htm", OB_OUTPUT_PAGE },    { ".mcap", OB_OUTPUT_MCAP },   { ".lua", OB_OUTPUT_SCENE },
	{ ".rgb", OB_OUTPUT_RAW },     { ".raw", OB_OUTPUT_RAW },
};

static const struct {
	ob_output kind;
	const char *name, *by;
} kinds_known[] = {
	{ OB_OUTPUT_RECORD, "a record", "--record" },
	{ OB_OUTPUT_VIDEO, "a video", "--out of obsim run, also with --replay" },
	{ OB_OUTPUT_PICTURE, "a picture", "--out DIR of obsim run, also with --replay" },
	{ OB_OUTPUT_RAW, "raw frames", "--out of obsim run, also with --replay" },
	{ OB_OUTPUT_JSON, "JSON", "--json" },
	{ OB_OUTPUT_CSV, "a table", "--series" },
	{ OB_OUTPUT_PAGE, "a page", "obsim export" },
	{ OB_OUTPUT_MCAP, "MCAP", "obsim export" },
	{ OB_OUTPUT_SCENE, "a scene", "obsim import" },
};

static const struct {
	ob_option_id option;
	unsigned kinds;
} outputs[] = {
	{ OB_OPTION_RECORD, OB_OUTPUT_RECORD },
	{ OB_OPTION_JSON, OB_OUTPUT_JSON },
	{ OB_OPTION_SERIES, OB_OUTPUT_CSV },
	{ OB_OPTION_TRACE, OB_OUTPUT_JSON },
	{ OB_OPTION_LOG_REQUESTS, 0 },
	{ OB_OPTION_CHECKPOINT, 0 },
	{ OB_OPTION_OUT, 0 },
};

static unsigned kind_of(const char *path)
{
	const size_t n = strlen(path);
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		const size_t m = strlen(ends[i].end);
		if (n >= m && strcasecmp(path + n - m, ends[i].end) == 0)
			return ends[i].kind;
	}
	return 0;
}

bool ob_output_kind(const char *path, ob_out *kind, ob_error *e)
{
	const char *slash = strrchr(path, '/'), *end = strrchr(slash ? slash : path, '.');
	struct stat s;
	const bool exists = stat(path, &s) == 0;
	*kind = OB_OUT_VIDEO;
	if (strcmp(path, "-") == 0 || kind_of(path) == OB_OUTPUT_RAW ||
	    (exists && !S_ISDIR(s.st_mode) && !S_ISREG(s.st_mode)))
		*kind = OB_OUT_RAW;
	else if ((exists && S_ISDIR(s.st_mode)) || !end || !isalpha((unsigned char)end[1]))
		*kind = OB_OUT_FOLDER;
	else
		return ob_output_fits("--out", path, OB_OUTPUT_VIDEO, e);
	return true;
}

bool ob_output_fits(const char *what, const char *path, unsigned kinds, ob_error *e)
{
	const unsigned kind = kind_of(path);
	for (size_t k = 0; !(kind & kinds) && k < sizeof kinds_known / sizeof *kinds_known; k++)
		if (kinds_known[k].kind == kind)
			return ob_fail(e, "%s %s: %s is the end of the name of %s, which %s writes", what, path,
				       strrchr(path, '.'), kinds_known[k].name, kinds_known[k].by);
	return true;
}

bool ob_output_check(ob_option_id id, const char *name, const char *path, ob_error *e)
{
	char what[64];
	for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
		if (outputs[i].option == id) {
			snprintf(what, sizeof what, "--%s", name);
			return ob_output_fits(what, path, outputs[i].kinds, e);
		}
	return true;
}
