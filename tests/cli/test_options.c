// The command line, word by word: accepted words, and the message for each mistake.
#include <string.h>

#include "check.h"
#include "cli/options.h"
#include "cli/output.h"

enum { WORDS_MAX = 16 };

// Splits at blanks, in place of a shell
static int split(char *line, char *words[WORDS_MAX])
{
	int n = 0;
	for (char *w = strtok(line, " "); w && n < WORDS_MAX; w = strtok(NULL, " "))
		words[n++] = w;
	return n;
}

static bool parse(ob_arguments *a, ob_command_bit command, const char *line, char *copy, ob_error *e)
{
	char *words[WORDS_MAX];
	strcpy(copy, line);
	int n = split(copy, words);
	e->text[0] = 0;
	return ob_options_parse(a, command, n, words, e);
}

static void check_refused(ob_command_bit command, const char *line, const char *part)
{
	ob_arguments a;
	ob_error e;
	char copy[256];
	bool taken = parse(&a, command, line, copy, &e);
	CHECK(!taken);
	CHECK(strstr(e.text, part));
	if (taken || !strstr(e.text, part))
		fprintf(stderr, "  '%s' gave '%s', expected '%s' in it\n", line, e.text, part);
	CHECK(!strchr(e.text, '\n'));
	ob_options_finish(&a);
}

// Accepted ends of names of the files that an option writes; NULL: it reads. Ends of all others are refused.
static const struct {
	ob_option_id option;
	const char *ends;
} files[] = {
	{ OB_OPTION_RECORD, ".h5 .hdf5" },
	{ OB_OPTION_JSON, ".json" },
	{ OB_OPTION_SERIES, ".csv" },
	{ OB_OPTION_TRACE, ".json" },
	{ OB_OPTION_CHECKPOINT, "" },
	{ OB_OPTION_LOG_REQUESTS, "" },
	{ OB_OPTION_OUT, "" },
	{ OB_OPTION_RESUME, NULL },
	{ OB_OPTION_REPLAY, NULL },
	{ OB_OPTION_REPLAY_REQUESTS, NULL },
};
enum { FILES = sizeof files / sizeof *files };

static void check_name(ob_command_bit command, const char *option, const char *end, bool fits)
{
	char line[128], copy[256], part[32];
	ob_arguments a;
	ob_error e;
	snprintf(line, sizeof line, "--%s boxes%s", option, end);
	snprintf(part, sizeof part, "%s is the end of", end);
	const bool taken = parse(&a, command, line, copy, &e);
	CHECK(taken == fits && (fits || strstr(e.text, part)));
	if (taken != fits)
		fprintf(stderr, "  %s: %s\n", line, taken ? "taken" : e.text);
	ob_options_finish(&a);
}

// A file's name does not end as those of another kind do: for each option that writes one.
static void test_outputs(void)
{
	static const char *const ends[] = { ".h5",   ".hdf5", ".mp4",  ".webm", ".mkv",  ".mov",
					    ".avi",  ".gif",  ".webp", ".png",  ".jpg",  ".jpeg",
					    ".json", ".csv",  ".html", ".htm",  ".mcap", ".lua" };
	for (int id = 0; id < OB_OPTIONS; id++) {
		const ob_option *o = &ob_option_table[id];
		int k = 0;
		while (k < FILES && files[k].option != (ob_option_id)id)
			k++;
		const bool names_file =
			o->argument && (strcmp(o->argument, "FILE") == 0 || strcmp(o->argument, "DIR") == 0);
		CHECK(names_file == (k < FILES));
		for (size_t i = 0; k < FILES && i < sizeof ends / sizeof *ends; i++) {
			const char *found = files[k].ends ? strstr(files[k].ends, ends[i]) : NULL;
			const bool fits = !files[k].ends || (found && strcspn(found, " ") == strlen(ends[i]));
			check_name((ob_command_bit)(o->commands & -o->commands), o->name, ends[i], fits);
		}
		if (k < FILES)
			check_name((ob_command_bit)(o->commands & -o->commands), o->name, ".of.mine", true);
	}
	check_refused(OB_COMMAND_RUN, "s.lua --record a.MP4",
		      "is the end of the name of a video, which --out of obsim run");
	check_refused(OB_COMMAND_RUN, "s.lua --series s.lua", "is the end of the name of a scene");
}

static ob_out kind_of(const char *path)
{
	ob_out kind = OB_OUTS;
	ob_error e;
	CHECK(ob_output_kind(path, &kind, &e));
	return kind;
}

// The name of a picture file gives its kind; a run writes one of each kind.
static void test_pictures(void)
{
	static const char *const videos[] = { "a.mp4", "./d.e/a.webm", "a.GIF", "a.xyz" };
	static const char *const raw[] = { "-", "a.rgb", "a.RAW", "/dev/null" };
	static const char *const folders[] = { "frames", "/tmp", "./f29.97", "a.mp4/b", "..", "a.b/" };
	for (size_t i = 0; i < sizeof videos / sizeof *videos; i++)
		CHECK(kind_of(videos[i]) == OB_OUT_VIDEO);
	for (size_t i = 0; i < sizeof raw / sizeof *raw; i++)
		CHECK(kind_of(raw[i]) == OB_OUT_RAW);
	for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
		CHECK(kind_of(folders[i]) == OB_OUT_FOLDER);
	ob_arguments a;
	ob_error e;
	char copy[256];
	CHECK(parse(&a, OB_COMMAND_RUN, "s.lua --out a.mp4 --out frames --out -", copy, &e));
	CHECK(strcmp(a.out[OB_OUT_VIDEO], "a.mp4") == 0 && strcmp(a.out[OB_OUT_FOLDER], "frames") == 0 &&
	      strcmp(a.out[OB_OUT_RAW], "-") == 0);
	ob_options_finish(&a);
	check_refused(OB_COMMAND_RUN, "s.lua --out a.mp4 --out b.gif", "--out a.mp4 and --out b.gif are of one kind");
	check_refused(OB_COMMAND_RUN, "s.lua --out a.h5", "is the end of the name of a record, which --record writes");
	check_refused(OB_COMMAND_RUN, "s.lua --out a.png", "is the end of the name of a picture, which --out DIR of");
	check_refused(OB_COMMAND_RUN, "s.lua --video a.mp4", "--video is now --out FILE.mp4");
	check_refused(OB_COMMAND_RUN, "s.lua --frames d", "--frames is now --out DIR");
	check_refused(OB_COMMAND_RUN, "s.lua --raw -", "--raw is now --out FILE.rgb, or -");
}

static void test_taken(void)
{
	ob_arguments a;
	ob_error e;
	char copy[256];
	CHECK(parse(&a, OB_COMMAND_RUN, "s.lua -D n=3 -Dm=x --arch=monolith --duration 2 --json - --seed -1", copy,
		    &e));
	CHECK(strcmp(a.operand, "s.lua") == 0);
	CHECK(a.defines == 2 && strcmp(a.define[0], "n=3") == 0 && strcmp(a.define[1], "m=x") == 0);
	CHECK(strcmp(a.setting[OB_SETTING_ARCHITECTURE], "monolith") == 0);
	CHECK(strcmp(a.value[OB_OPTION_DURATION], "2") == 0);
	CHECK(strcmp(a.value[OB_OPTION_JSON], "-") == 0);
	CHECK(strcmp(a.value[OB_OPTION_SEED], "-1") == 0); // a value; the request validates it
	CHECK(!a.setting[OB_SETTING_STEP] && !a.value[OB_OPTION_HELP]);
	ob_options_finish(&a);
	CHECK(parse(&a, OB_COMMAND_RUN, "--harden s.lua", copy, &e)); // its value stands behind a =, or not at all
	CHECK(strcmp(a.value[OB_OPTION_HARDEN], "") == 0 && strcmp(a.operand, "s.lua") == 0);
	ob_options_finish(&a);
	CHECK(parse(&a, OB_COMMAND_RUN, "s.lua --harden=pages,calls", copy, &e));
	CHECK(strcmp(a.value[OB_OPTION_HARDEN], "pages,calls") == 0);
	ob_options_finish(&a);
	CHECK(parse(&a, OB_COMMAND_TOP, "--once -- --odd", copy, &e));
	CHECK(a.value[OB_OPTION_ONCE] && strcmp(a.operand, "--odd") == 0);
	ob_options_finish(&a);
	CHECK(parse(&a, OB_COMMAND_COMPARE, "-h", copy, &e));
	CHECK(a.value[OB_OPTION_HELP] && !a.operand);
	ob_options_finish(&a);
}

static void test_refused(void)
{
	check_refused(OB_COMMAND_RUN, "s.lua --durration 3", "did you mean --duration?");
	check_refused(OB_COMMAND_RUN, "s.lua --work 3", "did you mean --workers?");
	check_refused(OB_COMMAND_RUN, "s.lua --zzzzzz", "--help lists");
	check_refused(OB_COMMAND_RUN, "s.lua -x", "unknown option -x");
	check_refused(OB_COMMAND_RUN, "s.lua -duration 3", "did you mean --duration?");
	check_refused(OB_COMMAND_RUN, "s.lua --once", "unknown option --once");
	check_refused(OB_COMMAND_COMPARE, "s.lua --frames d", "unknown option --frames");
	check_refused(OB_COMMAND_RUN, "s.lua --duration", "--duration needs a value");
	check_refused(OB_COMMAND_RUN, "s.lua --duration --step 1", "--duration needs a value");
	check_refused(OB_COMMAND_RUN, "s.lua --json=", "--json needs a value");
	check_refused(OB_COMMAND_RUN, "s.lua --harden=", "leave the = away");
	check_refused(OB_COMMAND_RUN, "s.lua --harden --harden=pages", "--harden is given twice");
	check_refused(OB_COMMAND_RUN, "s.lua --help=me", "--help takes no value");
	check_refused(OB_COMMAND_RUN, "s.lua --step 1 --step 1", "--step is given twice");
	check_refused(OB_COMMAND_RUN, "s.lua -D n=1 -D n=2", "-D n is given twice");
	check_refused(OB_COMMAND_RUN, "s.lua -D n", "expected NAME=VALUE");
	check_refused(OB_COMMAND_RUN, "s.lua -D =2", "expected NAME=VALUE");
	check_refused(OB_COMMAND_RUN, "s.lua --arch monolit", "did you mean monolith?");
	check_refused(OB_COMMAND_RUN, "s.lua --arch x", "expected one of obs|monolith");
	check_refused(OB_COMMAND_RUN, "s.lua t.lua", "one scene at a time");
	check_refused(OB_COMMAND_TOP, "a b", "one universe at a time");
}

// Names may share their beginning, but -D n=1 -D nn=2 are two.
static void test_defines_apart(void)
{
	ob_arguments a;
	ob_error e;
	char copy[256];
	CHECK(parse(&a, OB_COMMAND_RUN, "s.lua -D n=1 -D nn=2 -D m=1", copy, &e));
	CHECK(a.defines == 3);
	ob_options_finish(&a);
}

// Only the lab takes more than one operand.
static void test_operands(void)
{
	char copy[256];
	ob_arguments a;
	ob_error e;
	CHECK(parse(&a, OB_COMMAND_LAB, "pile --json 14 -- --list", copy, &e));
	CHECK(strcmp(a.operand, "pile") == 0 && a.value[OB_OPTION_JSON_OUT] && !a.value[OB_OPTION_LIST]);
	CHECK(strcmp(a.operands[0], "pile") == 0 && strcmp(a.operands[1], "14") == 0 &&
	      strcmp(a.operands[2], "--list") == 0 && !a.operands[3]);
	ob_options_finish(&a);
	CHECK(parse(&a, OB_COMMAND_LAB, "--quick", copy, &e) && !a.operand && !a.operands[0]);
	ob_options_finish(&a);
	check_refused(OB_COMMAND_LAB, "pile --json=x", "--json takes no value");
}

static void test_table(void)
{
	for (int i = 0; i < OB_OPTIONS; i++) {
		const ob_option *o = &ob_option_table[i];
		CHECK(o->name && (o->help || ob_setting_by_name(o->name) >= 0) && o->commands);
		for (int j = 0; j < i; j++)
			CHECK(strcmp(o->name, ob_option_table[j].name) != 0 ||
			      !(o->commands & ob_option_table[j].commands));
	}
}

int main(void)
{
	test_outputs();
	test_pictures();
	test_taken();
	test_refused();
	test_defines_apart();
	test_operands();
	test_table();
	return check_end();
}
