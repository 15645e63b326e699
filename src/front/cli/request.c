#include "cli/request.h"

#include <inttypes.h>
#include <libgen.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/cpu.h"
#include "base/hash.h"
#include "base/spelling.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "cli/shipped.h"
#include "cli/version.h"
#include "free/schedule.h"
#include "render/caption.h"
#include "settings/settings.h"

enum { WORKERS_MAX = 65536, SIZE_MIN = 16, SIZE_MAX_PIXELS = 16384 };

static const char *name_of(ob_option_id id)
{
	return ob_option_table[id].name;
}

static bool count(const ob_arguments *a, ob_option_id id, uint32_t least, uint32_t most, uint32_t *out, ob_error *e)
{
	uint64_t n = *out;
	bool fine = ob_number_count(name_of(id), a->value[id], least, most, &n, e);
	*out = (uint32_t)n;
	return fine;
}

static bool real(const ob_arguments *a, ob_option_id id, double most, double *out, ob_error *e)
{
	return ob_number_real(name_of(id), a->value[id], 0, most, out, e);
}

// dirname() writes into its argument.
static bool copy_path(char copy[PATH_MAX], const char *option, const char *path, ob_error *e)
{
	int n = snprintf(copy, PATH_MAX, "%s", path);
	return n < PATH_MAX ? true : ob_fail(e, "--%s: the path is too long", option);
}

// True if making the directory "made" makes dir on the way
static bool is_made(const char *dir, const char *made)
{
	size_t n = strlen(dir);
	return made && strncmp(made, dir, n) == 0 && (made[n] == '/' || !made[n]);
}

// Checks that a file may be written: its directory exists, or will once "made" does; NULL = none will be made
static bool check_file(const char *option, const char *path, const char *made, ob_error *e)
{
	char copy[PATH_MAX];
	if (!copy_path(copy, option, path, e))
		return false;
	const char *dir = dirname(copy);
	struct stat s;
	if (stat(dir, &s) != 0 && is_made(dir, made))
		return true;
	if (stat(dir, &s) != 0 || !S_ISDIR(s.st_mode))
		return ob_fail(e, "--%s %s: there is no directory %s: make it first", option, path, dir);
	if (stat(path, &s) == 0) {
		if (S_ISDIR(s.st_mode))
			return ob_fail(e, "--%s %s: this is a directory, expected a file", option, path);
		if (access(path, W_OK) != 0)
			return ob_fail(e, "--%s %s: may not be written", option, path);
	} else if (access(dir, W_OK | X_OK) != 0) {
		return ob_fail(e, "--%s %s: the directory %s may not be written", option, path, dir);
	}
	return true;
}

// Checks a directory for frames: it will be made if missing, with all its parents.
static bool check_directory(const char *option, const char *path, ob_error *e)
{
	struct stat s;
	if (stat(path, &s) != 0) {
		char copy[PATH_MAX];
		return copy_path(copy, option, path, e) && check_directory(option, dirname(copy), e);
	}
	if (!S_ISDIR(s.st_mode))
		return ob_fail(e, "--%s %s: this is a file, expected a directory", option, path);
	if (access(path, W_OK | X_OK) != 0)
		return ob_fail(e, "--%s %s: the directory may not be written", option, path);
	return true;
}

static bool is_stdout(const char *path)
{
	return path && strcmp(path, "-") == 0;
}

static bool check_outputs(const ob_arguments *a, ob_error *e)
{
	const char *folder = a->out[OB_OUT_FOLDER];
	const struct {
		const char *option, *path;
		bool may_be_stdout;
	} out[] = {
		{ "out", folder, false },
		{ "out", a->out[OB_OUT_VIDEO], false },
		{ "out", a->out[OB_OUT_RAW], true },
		{ "record", a->value[OB_OPTION_RECORD], false },
		{ "series", a->value[OB_OPTION_SERIES], false },
		{ "json", a->value[OB_OPTION_JSON], true },
		{ "trace", a->value[OB_OPTION_TRACE], false },
		{ "checkpoint", a->value[OB_OPTION_CHECKPOINT], false },
		{ "set record_schedule", a->setting[OB_SETTING_RECORD_SCHEDULE], false },
	};
	for (size_t i = 0; i < sizeof out / sizeof *out; i++) {
		const char *path = out[i].path, *option = out[i].option;
		for (size_t j = 0; path && j < i; j++)
			if (out[j].path && strcmp(out[j].path, path) == 0)
				return ob_fail(e, "--%s and --%s both write %s", out[j].option, option,
					       is_stdout(path) ? "standard output" : path);
		if (is_stdout(path) && !out[i].may_be_stdout)
			return ob_fail(e, "--%s: cannot write to standard output, name a file", option);
		const bool fine = !path || is_stdout(path) ||
				  (i == 0 ? check_directory(option, path, e) : check_file(option, path, folder, e));
		if (!fine)
			return false;
	}
	return !a->setting[OB_SETTING_RECORD_SCHEDULE] ||
	       ob_output_fits("--set record_schedule", a->setting[OB_SETTING_RECORD_SCHEDULE], 0, e);
}

// Checks the file of a checkpoint, which is written beside it and then replaces it: a regular file, or none yet.
static bool check_checkpoint(const char *path, ob_error *e)
{
	struct stat s;
	char copy[PATH_MAX];
	if (!path)
		return true;
	if (stat(path, &s) == 0 && !S_ISREG(s.st_mode))
		return ob_fail(e, "--checkpoint %s: this is no file", path);
	if (!copy_path(copy, name_of(OB_OPTION_CHECKPOINT), path, e))
		return false;
	const char *dir = dirname(copy);
	return access(dir, W_OK | X_OK) == 0 ||
	       ob_fail(e, "--checkpoint %s: the directory %s may not be written", path, dir);
}

static bool read_checkpoint(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	r->checkpoint = a->value[OB_OPTION_CHECKPOINT];
	if (a->setting[OB_SETTING_EVERY] && !r->checkpoint)
		return ob_fail(e, "--set every needs --checkpoint");
	return check_checkpoint(r->checkpoint, e);
}

// Refuses options that belong to the run that is resumed.
static bool check_resumed(const ob_arguments *a, ob_error *e)
{
	if (a->operand)
		return ob_fail(e, "--resume and the scene %s: expected one of them, for a checkpoint holds its scene",
			       a->operand);
	return ob_options_refuse(a, OB_BIT(OB_OPTION_DEFINE) | OB_BIT(OB_OPTION_SEED), OB_LOCKSTEP_BITS,
				 ": a resumed run keeps the settings that it has; leave this away", e);
}

static bool read_overlay(ob_frames_request *f, const char *list, ob_error *e)
{
	while (list && *list) {
		size_t n = strcspn(list, ",");
		if (n == 4 && strncmp(list, "aabb", n) == 0)
			f->aabb = true;
		else if (n == 8 && strncmp(list, "contacts", n) == 0)
			f->contacts = true;
		else if (n == 6 && strncmp(list, "joints", n) == 0)
			f->joints = true;
		else if (n == 7 && strncmp(list, "caption", n) == 0)
			f->caption = true;
		else if (n == 10 && strncmp(list, "simulators", n) == 0)
			f->simulators = true;
		else if (n >= 5 && n < 6 + sizeof f->reader && strncmp(list, "reads=", n < 6 ? n : 6) == 0) {
			f->reads = true;
			snprintf(f->reader, sizeof f->reader, "%.*s", n < 6 ? 0 : (int)n - 6, list + (n < 6 ? n : 6));
		} else
			return ob_fail(e,
				       "--overlay %.*s: expected aabb, contacts, joints, reads, reads=OBJECT, "
				       "simulators or caption, as in aabb,contacts",
				       (int)n, list);
		list += n + (list[n] == ',');
	}
	return true;
}

// Reads ascending times, as 0,.5,2.
static bool read_stills(ob_frames_request *f, const ob_arguments *a, ob_error *e)
{
	const char *list = a->value[OB_OPTION_STILL];
	if (list && (f->video || a->value[OB_OPTION_FPS]))
		return ob_fail(e, "--still gives single frames: leave %s away", f->video ? "the video" : "--fps");
	for (; list && *list; f->stills++) {
		char number[32];
		const size_t n = strcspn(list, ",");
		double *t = &f->still[f->stills];
		if (f->stills == OB_STILLS_MAX)
			return ob_fail(e, "--still: expected at most %d times", OB_STILLS_MAX);
		snprintf(number, sizeof number, "%.*s", (int)n, list);
		*t = 0;
		if (strcmp(number, "0") != 0 && !ob_number_real(name_of(OB_OPTION_STILL), number, 0, 1e9, t, e))
			return false;
		if (f->stills > 0 && !(*t > t[-1]))
			return ob_fail(e, "--still %s: expected growing times, as .5,2", a->value[OB_OPTION_STILL]);
		list += n + (list[n] == ',');
	}
	return !list || f->stills > 0 || ob_fail(e, "--still: expected times, as .5,2");
}

static bool read_size(ob_frames_request *f, const char *text, ob_error *e)
{
	if (!text)
		return true;
	int end = 0;
	if (sscanf(text, "%5dx%5d%n", &f->width, &f->height, &end) != 2 || text[end])
		return ob_fail(e, "--size %s: expected WIDTHxHEIGHT, as 1280x720", text);
	if (f->width < SIZE_MIN || f->height < SIZE_MIN || f->width > SIZE_MAX_PIXELS || f->height > SIZE_MAX_PIXELS)
		return ob_fail(e, "--size %s: expected %d to %d pixels each way", text, SIZE_MIN, SIZE_MAX_PIXELS);
	return true;
}

static bool read_frames(ob_frames_request *f, const ob_arguments *a, const ob_settings *asked, ob_error *e)
{
	*f = (ob_frames_request){
		.dir = a->out[OB_OUT_FOLDER],
		.video = a->out[OB_OUT_VIDEO],
		.raw = a->out[OB_OUT_RAW],
		.gpu = asked->gpu,
		.camera = a->value[OB_OPTION_CAMERA],
		.fps = 60,
		.width = 1280,
		.height = 720,
	};
	f->wanted = f->dir || f->video || f->raw;
	const uint64_t details = OB_BIT(OB_OPTION_FPS) | OB_BIT(OB_OPTION_SIZE) | OB_BIT(OB_OPTION_QUALITY) |
				 OB_BIT(OB_OPTION_CAMERA) | OB_BIT(OB_OPTION_OVERLAY) | OB_BIT(OB_OPTION_STILL) |
				 OB_BIT(OB_OPTION_COLOUR_BY);
	if (!f->wanted &&
	    !ob_options_refuse(a, details, OB_BIT(OB_SETTING_SAMPLES) | OB_BIT(OB_SETTING_GPU), " needs --out", e))
		return false;
	if (f->gpu && strcmp(f->gpu, "surfaceless") != 0 && strspn(f->gpu, "0123456789") != strlen(f->gpu))
		return ob_fail(e, "--set gpu=%s: expected surfaceless, or the number of a GPU, from 0", f->gpu);
	const char *quality = a->value[OB_OPTION_QUALITY];
	uint32_t key = OB_COLOUR_OWN;
	if (a->value[OB_OPTION_COLOUR_BY])
		ob_setting_find(OB_COLOUR_KEY_NAMES, a->value[OB_OPTION_COLOUR_BY], &key);
	f->colour_by = (ob_colour_key)key;
	f->quality = quality && strcmp(quality, "fine") == 0 ? OB_QUALITY_FINE : OB_QUALITY_DRAFT;
	const uint32_t most = f->quality == OB_QUALITY_FINE ? 256 : 32;
	if (asked->samples > most)
		return ob_fail(e, "--set samples=%u: expected 1 to %u for this --quality", asked->samples, most);
	f->samples = asked->samples                  ? (int)asked->samples
		     : f->quality == OB_QUALITY_FINE ? 16
						     : 0; // 0: the renderer's choice
	if (!real(a, OB_OPTION_FPS, 1e5, &f->fps, e) || !read_stills(f, a, e) ||
	    !read_size(f, a->value[OB_OPTION_SIZE], e))
		return false;
	if (f->video && (f->width % 2 || f->height % 2))
		return ob_fail(e, "--size %dx%d: a video needs an even width and height", f->width, f->height);
	return read_overlay(f, a->value[OB_OPTION_OVERLAY], e) && (!f->wanted || ob_render_check(e)) &&
	       (!f->video || ob_video_check(e)) && (!(f->caption || f->simulators) || ob_caption_check(e));
}

static bool read_workers(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	const char *text = a->value[OB_OPTION_WORKERS];
	bool objects = text && strcmp(text, "objects") == 0, monolith = r->asked.run.monolith == 1;
	r->workers = monolith || objects ? !objects : (uint32_t)ob_cpu_count();
	if (text && !objects && strspn(text, "0123456789") != strlen(text))
		return ob_fail(e, "--workers %s: expected a number, or objects", text);
	if (!objects && !count(a, OB_OPTION_WORKERS, 1, WORKERS_MAX, &r->workers, e))
		return false;
	if (monolith && r->workers != 1)
		return ob_fail(e, "--workers %s: the monolith is one world with one worker; leave --workers away",
			       text);
	return true;
}

static bool read_harden(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	if (!ob_harden_read(&r->harden, a->value[OB_OPTION_HARDEN], e))
		return false;
	if (a->command == OB_COMMAND_COMPARE) // compare sets it by configurations
		r->harden = 0;
	if (r->harden && r->asked.run.monolith == 1)
		return ob_fail(e,
			       "--harden: a monolith is one simulator, which writes all; leave --arch monolith away");
	if (r->harden && !r->isolation_given)
		r->isolation = OB_ISOLATION_PROCESS;
	if (r->harden && r->isolation != OB_ISOLATION_PROCESS)
		return ob_fail(e, "--harden: threads share all their memory; leave --isolation away, or take process");
	return true;
}

// Reads the policy for deaths of simulators, and their limit: "5/10" is five deaths within ten seconds.
static bool read_deaths(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	const char *policy = a->value[OB_OPTION_ON_DEATH], *limit = r->asked.restarts;
	uint32_t value = OB_ON_DEATH_RESTART;
	uint64_t deaths = 0;
	char number[32];
	if (policy)
		ob_setting_find(OB_ON_DEATH_NAMES, policy, &value);
	r->on_death = (ob_on_death)value;
	if (ob_on_death_freezes_failed(r->on_death) && r->asked.run.monolith == 1)
		return ob_fail(e,
			       "--on-death %s: a monolith is one simulator, without which nothing goes on; leave "
			       "--arch monolith away",
			       policy);
	if (!limit)
		return true;
	const char *slash = strchr(limit, '/');
	if (!slash || (size_t)(slash - limit) >= sizeof number)
		return ob_fail(e, "--set restarts=%s: expected a number and seconds, as in 5/10", limit);
	snprintf(number, sizeof number, "%.*s", (int)(slash - limit), limit);
	if (!ob_number_count("set restarts", number, 1, OB_RESTART_LIMIT_MAX, &deaths, e) ||
	    !ob_number_real("set restarts", slash + 1, 0, 1e9, &r->limit.seconds, e))
		return false;
	r->limit.deaths = (uint32_t)deaths;
	return r->on_death != OB_ON_DEATH_ABORT ||
	       ob_fail(e, "--set restarts: with --on-death abort nothing is restarted; leave one of them away");
}

static bool read_tolerance(ob_settings *to, const char *text, ob_error *e)
{
	const ob_setting *s = &ob_setting_table[OB_SETTING_TOLERANCE];
	ob_length l;
	if (!ob_length_read(text, &l))
		return ob_fail(e, "--tolerance %s: expected %s", text, OB_LENGTH_FORMS);
	if (!(l.share > 0) && !(l.m >= s->least && l.m <= s->most))
		return ob_fail(e, "--tolerance %s: expected %gm to %gm", text, s->least, s->most);
	to->tolerance_share = l.share;
	to->run.tolerance = l.share > 0 ? OB_DEFAULT_TOLERANCE : l.m; // the default, until the scene is known
	return true;
}

static bool read_real(double *to, const ob_setting *s, const char *option, const char *text, ob_error *e)
{
	if (strstr(s->form, "none") && strcmp(text, "none") == 0) {
		*to = INFINITY;
		return true;
	}
	const bool above = s->flags & OB_SETTING_ABOVE;
	if (!above && s->least == 0 && strcmp(text, "0") == 0) {
		*to = 0;
		return true;
	}
	return ob_number_real(option, text, s->least, s->most, to, e);
}

bool ob_request_read_settings(ob_settings *to, const ob_arguments *a, ob_error *e)
{
	for (int i = 0; i < OB_SETTINGS; i++) {
		const ob_setting *s = &ob_setting_table[i];
		const char *text = a->setting[i];
		const ob_setting_word option = ob_setting_option((ob_setting_id)i);
		void *at = (char *)to + s->offset;
		uint64_t n = 0;
		bool fine = true;
		if (!text)
			continue;
		to->given |= 1ull << i;
		if (i == OB_SETTING_TOLERANCE)
			fine = read_tolerance(to, text, e);
		else if (s->kind == OB_SETTING_REAL)
			fine = read_real(at, s, option.text, text, e);
		else if (s->kind == OB_SETTING_TEXT)
			*(const char **)at = text;
		else if (s->kind == OB_SETTING_COUNT)
			fine = ob_number_count(option.text, text, (uint64_t)s->least, (uint64_t)s->most, &n, e);
		else
			fine = ob_setting_find(s->form, text, at) ||
			       ob_fail(e, "--%s %s: a run has one of %s; obsim compare runs both ways", option.text,
				       text, s->form);
		if (!fine)
			return false;
		if (s->kind == OB_SETTING_COUNT)
			*(uint32_t *)at = (uint32_t)n;
	}
	return true;
}

static bool read_settings(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	r->asked = (ob_settings){ .every = 1 };
	if (a->setting[OB_SETTING_TOLERANCE] && a->setting[OB_SETTING_SUBSTEPS])
		return ob_fail(e, "--tolerance and --set substeps: expected one of them, for a tolerance chooses the "
				  "substeps");
	if (!ob_request_read_settings(&r->asked, a, e))
		return false;
	r->patience = r->asked.patience;
	return true;
}

// Reads one kind of "a+b+c"; moves *at past it.
static bool read_fault_kind(ob_fault_plan *f, const char **at, ob_error *e)
{
	char word[16];
	uint32_t kind;
	const size_t n = strcspn(*at, "+:");
	snprintf(word, sizeof word, "%.*s", (int)(n < sizeof word ? n : sizeof word - 1), *at);
	if (!ob_setting_find(OB_FAULT_NAMES, word, &kind))
		return ob_fail(e, "--fault %s: expected some of %s, with + between them", word, OB_FAULT_NAMES);
	f->kinds |= 1u << kind;
	*at += n;
	return true;
}

// Reads one "name=value"; moves *at past it.
static bool read_fault_number(ob_fault_plan *f, const char **at, ob_error *e)
{
	char word[64], *value;
	uint64_t n = 0;
	const size_t length = strcspn(*at, ",");
	snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), *at);
	*at += length + ((*at)[length] == ',');
	value = strchr(word, '=');
	if (!value)
		return ob_fail(e, "--fault %s: expected p=, seed=, words= or ms=", word);
	*value++ = 0;
	if (strcmp(word, "p") == 0)
		return ob_number_real("fault p", value, 0, 1, &f->probability, e);
	if (strcmp(word, "seed") == 0)
		return ob_number_count("fault seed", value, 0, UINT64_MAX, &f->seed, e);
	const bool words = strcmp(word, "words") == 0;
	if (!words && strcmp(word, "ms") != 0)
		return ob_fail(e, "--fault %s: expected p=, seed=, words= or ms=", word);
	if (!ob_number_count(words ? "fault words" : "fault ms", value, 1, 100000, &n, e))
		return false;
	*(words ? &f->words : &f->sleep_ms) = (uint32_t)n;
	return true;
}

// Reads faults: "kill+exit:p=.001,seed=7"
static bool read_fault(ob_run_request *r, const char *text, ob_error *e)
{
	ob_fault_plan f = { .seed = 1, .words = 1, .sleep_ms = 20 };
	if (!text)
		return true;
	do
		if (!read_fault_kind(&f, &text, e))
			return false;
	while (*text++ == '+');
	for (; text[-1] && *text;)
		if (!read_fault_number(&f, &text, e))
			return false;
	if (!(f.probability > 0))
		return ob_fail(e, "--fault: expected the probability of a fault at each chance, as in kill:p=.001");
	const uint32_t anywhere = 1u << OB_FAULT_SLOW | 1u << OB_FAULT_NOSPACE | 1u << OB_FAULT_NOPAGES;
	if (f.kinds & ~anywhere && r->isolation != OB_ISOLATION_PROCESS)
		return ob_fail(e, "--fault: only slow, nospace and nopages can happen to a thread; give the simulators "
				  "processes of their own: --isolation process");
	if (f.kinds & 1u << OB_FAULT_NOSPACE && !r->checkpoint)
		return ob_fail(e, "--fault nospace is for --checkpoint");
	r->fault = f;
	return true;
}

static bool check_name(const char *name, ob_error *e)
{
	static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
	if (!name)
		return true;
	size_t n = strlen(name);
	if (n >= OB_NAME_MAX || strspn(name, allowed) != n || strchr("._-", name[0]))
		return ob_fail(e, "--name %s: expected at most %d letters, digits, . _ - and a letter or digit first",
			       name, OB_NAME_MAX - 1);
	return true;
}

// Reads the pace. By default, run is as fast as possible, and serve runs in real time.
static bool read_pace(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	const char *text = a->value[OB_OPTION_PACE];
	r->pace = a->command == OB_COMMAND_SERVE ? 1 : OB_PACE_MAX;
	if (text && strcmp(text, "realtime") == 0)
		r->pace = 1;
	else if (text && strcmp(text, "max") == 0)
		r->pace = OB_PACE_MAX;
	else
		return real(a, OB_OPTION_PACE, 1e6, &r->pace, e);
	return true;
}

bool ob_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	static const char *const verbs[] = { [OB_COMMAND_RUN] = "run",
					     [OB_COMMAND_COMPARE] = "compare",
					     [OB_COMMAND_SERVE] = "serve",
					     [OB_COMMAND_CONTROL] = "control" };
	const char *resume = a->value[OB_OPTION_RESUME];
	if (resume && !check_resumed(a, e))
		return false;
	if (!a->operand && !resume)
		return ob_fail(e, "no scene given: obsim %s falling_boxes", verbs[a->command]);
	const char *isolation = a->value[OB_OPTION_ISOLATION];
	*r = (ob_run_request){
		.scene = ob_shipped_find(a->operand),
		.resume = resume,
		.scene_options = { .defines = a->define, .define_count = a->defines },
		.name = a->value[OB_OPTION_NAME],
		.isolation = isolation ? strcmp(isolation, "process") == 0 ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD
			     : a->command == OB_COMMAND_SERVE ? OB_ISOLATION_PROCESS // visitors kill simulators
							      : OB_ISOLATION_THREAD,
		.isolation_given = isolation != NULL,
		.explain = a->value[OB_OPTION_EXPLAIN] != NULL,
		.strict = a->value[OB_OPTION_STRICT] != NULL,
		.check = a->value[OB_OPTION_CHECK] != NULL,
		.record = a->value[OB_OPTION_RECORD],
		.series = a->value[OB_OPTION_SERIES],
		.trace = a->value[OB_OPTION_TRACE],
		.json = a->value[OB_OPTION_JSON],
		.full_report = a->value[OB_OPTION_REPORT] && strcmp(a->value[OB_OPTION_REPORT], "full") == 0,
	};
	r->scene_options.has_seed = a->value[OB_OPTION_SEED] != NULL;
	if (!read_settings(r, a, e))
		return false;
	if (r->asked.measure != OB_MEASURE_STEPS && r->series)
		return ob_fail(e, "--series has a line for each step: it needs --set measure=step");
	return real(a, OB_OPTION_DURATION, 1e9, &r->duration, e) &&
	       ob_number_count("seed", a->value[OB_OPTION_SEED], 0, UINT64_MAX, &r->scene_options.seed, e) &&
	       read_pace(r, a, e) && read_workers(r, a, e) && read_harden(r, a, e) && read_deaths(r, a, e) &&
	       (!r->record || ob_record_check(e)) && check_name(r->name, e) &&
	       read_frames(&r->frames, a, &r->asked, e) && check_outputs(a, e) && read_checkpoint(r, a, e) &&
	       read_fault(r, a->value[OB_OPTION_FAULT], e) && ob_free_request_read(r, a, e);
}

bool ob_request_check_replay(const ob_arguments *a, uint64_t options, uint64_t settings, ob_error *e)
{
	if (a->operand)
		return ob_fail(e,
			       "--replay and the scene %s: expected one of them, for a record holds all that is shown",
			       a->operand);
	return ob_options_refuse(a, ~options, ~settings, ": a record is shown as it was run; leave this away", e);
}

bool ob_request_read_replay(ob_replay_request *r, const ob_arguments *a, ob_error *e)
{
	const uint64_t allowed = OB_BIT(OB_OPTION_REPLAY) | OB_BIT(OB_OPTION_DURATION) | OB_BIT(OB_OPTION_PICTURES) |
				 OB_BIT(OB_OPTION_FPS) | OB_BIT(OB_OPTION_SIZE) | OB_BIT(OB_OPTION_QUALITY) |
				 OB_BIT(OB_OPTION_CAMERA) | OB_BIT(OB_OPTION_STILL) | OB_BIT(OB_OPTION_COLOUR_BY) |
				 OB_BIT(OB_OPTION_OVERLAY);
	ob_settings asked = { 0 };
	*r = (ob_replay_request){ .record = a->value[OB_OPTION_REPLAY] };
	if (!ob_request_check_replay(a, allowed, OB_BIT(OB_SETTING_SAMPLES) | OB_BIT(OB_SETTING_GPU), e) ||
	    !ob_request_read_settings(&asked, a, e) || !read_frames(&r->frames, a, &asked, e) ||
	    !real(a, OB_OPTION_DURATION, 1e9, &r->duration, e) || !check_outputs(a, e))
		return false;
	if (!r->frames.wanted)
		return ob_fail(e, "--replay needs --out; obsim serve --replay %s shows it in a browser", r->record);
	if (r->frames.colour_by >= OB_COLOUR_WORKER && r->frames.colour_by <= OB_COLOUR_RANK)
		return ob_fail(e,
			       "--colour-by %s: a record does not hold where simulators ran; simulator, island, "
			       "rest and cost can be shown",
			       a->value[OB_OPTION_COLOUR_BY]);
	if (r->frames.simulators)
		return ob_fail(e, "--overlay simulators: a record does not hold where simulators ran");
	if (r->frames.reads)
		return ob_fail(e, "--overlay reads: a record does not hold what simulators read");
	return !r->frames.contacts || ob_fail(e, "--overlay contacts: a record holds no contacts");
}

ob_host_config ob_request_host(const ob_run_request *r)
{
	return (ob_host_config){ .run = r->run,
				 .free = r->is_free ? &r->free : NULL,
				 .name = r->name,
				 .isolation = r->isolation,
				 .workers = r->workers,
				 .harden = r->harden,
				 .check = r->check,
				 .trace = r->trace,
				 .patience = r->patience,
				 .on_death = r->on_death,
				 .limit = r->limit };
}

ob_recorder *ob_request_record(const ob_run_request *r, const ob_scene *scene, const ob_universe *u, ob_error *e)
{
	ob_record_facts facts = { .scene = scene,
				  .path = r->scene,
				  .options = &r->scene_options,
				  .settings = &r->run,
				  .duration = r->duration,
				  .commit = ob_version_commit };
	ob_universe_get_info(u, &facts.universe);
	facts.universe.capacity = scene->objects; // spare slots get columns once they are used
	return ob_recorder_create(r->record, &facts, e);
}

uint64_t ob_request_steps(double duration, double step)
{
	// 10 s at 1/60 s are 600 steps, though the quotient of the doubles may be a little off
	double n = ceil(duration / step * (1 - 1e-12) - 1e-9);
	return n < 1 ? 1 : n < 1e18 ? (uint64_t)n : (uint64_t)1e18;
}

bool ob_request_check_frames(const ob_frames_request *f, const ob_scene *s, double duration, ob_error *e)
{
	const char *name = f->camera;
	if (f->stills && f->still[f->stills - 1] > duration * (1 + 1e-12))
		return ob_fail(e, "--still %g: the run ends at %g s; add --duration", f->still[f->stills - 1],
			       duration);
	if (!name)
		return true;
	ob_spelling near = ob_spelling_start(name);
	char all[512] = "";
	for (uint32_t i = 0; i < s->cameras; i++) {
		if (strcmp(s->camera[i].name, name) == 0)
			return true;
		ob_spelling_offer(&near, s->camera[i].name);
		size_t n = strlen(all);
		snprintf(all + n, sizeof all - n, "%s%s", i ? ", " : "", s->camera[i].name);
	}
	if (near.best)
		return ob_fail(e, "--camera %s: the scene has none of this name: did you mean %s?", name, near.best);
	return ob_fail(e, "--camera %s: the scene has none of this name, only: %s", name, all);
}

// Checks the resolved run against the request.
static bool check_run(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	if (r->run.monolith && r->explain)
		return ob_fail(e, "--explain means nothing to --arch monolith");
	if (r->run.monolith && r->checkpoint)
		return ob_fail(
			e,
			"--checkpoint: a monolith cannot be resumed, for ODE does not show all that its world holds");
	if (r->strict && !(r->run.tolerance > 0) && !s->scripts)
		return ob_fail(e, "--strict: this run has no tolerance that it could miss, and no scripts; give it one "
				  "with --tolerance");
	if (r->run.monolith && r->asked.run.verify)
		return ob_fail(e, "--set verify=on means nothing to --arch monolith");
	r->run.verify = r->asked.run.verify;
	r->run.fault = r->fault;
	r->run.timed = r->explain || r->asked.measure == OB_MEASURE_PROFILE;
	uint64_t steps = ob_request_steps(r->duration, r->run.step_length);
	// a motion carries its step as 32 bits
	if (steps > UINT32_MAX - 2)
		return ob_fail(e, "%g s in steps of %g s are too many steps (at most %" PRIu32 "): shorten --duration",
			       r->duration, r->run.step_length, UINT32_MAX - 2);
	return ob_request_check_frames(&r->frames, s, r->duration, e);
}

// Sets the tolerance if it is a share of the thinnest object's thickness. A scene in which nothing moves keeps the default.
static bool resolve_share(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	const ob_setting *t = &ob_setting_table[OB_SETTING_TOLERANCE];
	const double thin = ob_scene_thinnest(s), tolerance = r->asked.tolerance_share * thin;
	if (!(r->asked.tolerance_share > 0) || isinf(thin))
		return true;
	if (tolerance < t->least || tolerance > t->most)
		return ob_fail(e, "--tolerance %g%%: of the thinnest object's %gm that is %gm; expected %gm to %gm",
			       100 * r->asked.tolerance_share, thin, tolerance, t->least, t->most);
	r->asked.run.tolerance = tolerance;
	return true;
}

bool ob_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	if (!resolve_share(r, s, e))
		return false;
	r->duration = r->duration > 0 ? r->duration : s->duration;
	r->run = s->run;
	return ob_run_settings_resolve(&r->run, &r->asked, e) && ob_free_request_resolve(r, s, e) && check_run(r, s, e);
}

bool ob_request_resume(ob_run_request *r, const ob_saved_run *saved, const ob_scene *s, ob_error *e)
{
	const double now = (double)saved->host.universe.step * saved->settings.step_length;
	r->scene = saved->scene;
	r->scene_options = saved->options;
	r->run = saved->settings;
	if (r->duration > 0 && ob_request_steps(r->duration, r->run.step_length) < saved->host.universe.step)
		return ob_fail(e, "--duration %g: the run in %s is at %g s already", r->duration, r->resume, now);
	r->duration = r->duration > 0 ? r->duration : saved->duration;
	return check_run(r, s, e);
}

// ---- free request

// Options of a free run (obsim run --sync free).

static const double steps_of_lag = 2; // bound of the lag where the clock gives none, in steps of a simulator

// Settings that a run in lockstep has not.
static const uint64_t of_free = OB_BIT(OB_SETTING_UPDATE_RATE) | OB_BIT(OB_SETTING_COUPLING) |
				OB_BIT(OB_SETTING_MAX_LAG) | OB_BIT(OB_SETTING_JITTER) | OB_BIT(OB_SETTING_DELAY) |
				OB_BIT(OB_SETTING_RECORD_SCHEDULE);

bool ob_free_request_read(ob_run_request *r, const ob_arguments *a, ob_error *e)
{
	const uint64_t settled = OB_BIT(OB_OPTION_PACE) | OB_BIT(OB_OPTION_ISOLATION) | OB_BIT(OB_OPTION_WORKERS) |
				 OB_BIT(OB_OPTION_FAULT);
	// what a free run has not
	const uint64_t settings = OB_BIT(OB_SETTING_ARCHITECTURE);
	const uint64_t options = OB_BIT(OB_OPTION_HARDEN) | OB_BIT(OB_OPTION_STRICT) | OB_BIT(OB_OPTION_EXPLAIN) |
				 OB_BIT(OB_OPTION_CHECK) | OB_BIT(OB_OPTION_CHECKPOINT) | OB_BIT(OB_OPTION_RESUME) |
				 OB_BIT(OB_OPTION_ON_DEATH);
	const char *value = NULL;
	r->free_command = a->command == OB_COMMAND_RUN || a->command == OB_COMMAND_SERVE;
	r->of_free = ob_options_given(a, 0, of_free | OB_BIT(OB_SETTING_REPLAY_SCHEDULE));
	r->of_lockstep = ob_options_given(a, options, settings);
	r->of_own_step = ob_options_given(a, 0, OB_BIT(OB_SETTING_TOLERANCE) | OB_BIT(OB_SETTING_LAG));
	if (a->value[OB_OPTION_OVERLAY] && strstr(a->value[OB_OPTION_OVERLAY], "contacts"))
		value = "overlay contacts";
	if (ob_setting_is_set(&r->asked, OB_SETTING_SLEEPING) && r->asked.run.sleeping)
		snprintf(r->of_own_step.text, sizeof r->of_own_step.text, "set sleeping=on");
	if (r->asked.measure == OB_MEASURE_PROFILE)
		value = "set measure=profile";
	if (value)
		snprintf(r->of_lockstep.text, sizeof r->of_lockstep.text, "%s", value);
	return !r->asked.replay_schedule ||
	       ob_options_refuse(
		       a, settled, of_free,
		       " does not go with --set replay_schedule, which repeats a run as it was: leave it away", e);
}

static bool has_compounds(const ob_scene *s)
{
	uint32_t i = 0;
	while (i < s->hulls && !s->hull[i].parts)
		i++;
	return i < s->hulls;
}

// Refuses what bodies that are solved together cannot have.
static bool check_groups(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	const bool bound =
		ob_setting_is_set(&r->asked, OB_SETTING_MAX_LAG) || ob_setting_is_set(&s->asked, OB_SETTING_MAX_LAG);
	const char *const given =
		r->asked.record_schedule ? "record_schedule"
		: r->free.jitter > 0     ? "jitter"
		: r->free.delay > 0      ? "delay"
		: bound                  ? "max_lag"
		: r->free.rate_most != r->free.update_rate || r->free.update_rate != 1 / r->run.step_length
			? "update_rate"
			: NULL;
	return !given ||
	       ob_fail(e,
		       "%s is for simulators that solve contacts each for itself (--set coupling=own): in groups all "
		       "step at the rate of --step, and read nothing late",
		       given);
}

// Refuses what simulators that solve contacts each for itself cannot have.
static bool check_own(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	const char *const refused = *r->of_own_step.text ? r->of_own_step.text
				    : has_compounds(s)   ? "a scene with compounds"
				    : s->terrains        ? "a scene with heightfields or meshes"
							 : NULL;
	return !refused || ob_fail(e, "%s%s does not go with --set coupling=own: leave that away",
				   *r->of_own_step.text ? "--" : "", refused);
}

// Refuses what a free run cannot have.
static bool check(const ob_run_request *r, const ob_scene *s, ob_error *e)
{
	if (!r->free_command)
		return ob_fail(
			e,
			"the scene runs free (scene.sync), which obsim run and serve can do: set sync = \"lockstep\"");
	if (*r->of_lockstep.text)
		return ob_fail(e, "--%s does not go with --sync free: leave one of them away", r->of_lockstep.text);
	if (r->run.monolith || r->run.solver == OB_SOLVER_JACOBI)
		return ob_fail(e, "--sync free: expected object simulators with the solver coloured, ghost or lagged");
	if (s->scripts > 0)
		return ob_fail(e, "--sync free: the scene has scripts, which run in lockstep alone");
	if (s->joints > 0)
		return ob_fail(e, "--sync free: the scene has joints, which hold in lockstep alone");
	return r->free.coupling == OB_COUPLING_GROUP ? check_groups(r, s, e) : check_own(r, s, e);
}

// Digest of all that decides a free run beside its settings and its schedule.
static uint64_t digest_of(const ob_run_request *r, const ob_scene *s)
{
	const ob_scene_options *o = &r->scene_options;
	ob_run_settings run = r->run;
	memset(&run.fault, 0, sizeof run.fault);
	run.timed = run.load = 0;
	uint64_t hash = ob_hash_on(OB_HASH_BEGIN, s->text, s->text_size);
	for (uint32_t i = 0; i < o->define_count; i++)
		hash = ob_hash_on(hash, o->defines[i], strlen(o->defines[i]) + 1);
	hash = ob_hash_on(hash, &s->seed, sizeof s->seed);
	hash = ob_hash_on(hash, &r->duration, sizeof r->duration);
	return ob_hash_on(hash, &run, sizeof run);
}

// Names the schedule's file in the settings, for workers of any process. Replay: takes the recorded settings.
static bool resolve_schedule(ob_run_request *r, ob_error *e)
{
	ob_free_settings *f = &r->free;
	const ob_settings *asked = &r->asked;
	const char *path = asked->replay_schedule ? asked->replay_schedule : asked->record_schedule;
	if (!path)
		return true;
	if (asked->replay_schedule) {
		if (!ob_free_schedule_check(path, r->schedule_digest, f, e))
			return false;
		f->replays = 1;
		r->workers = 1;
		r->isolation = OB_ISOLATION_THREAD;
	}
	char *here = *path == '/' ? NULL : realpath(".", NULL);
	const int n = snprintf(f->schedule, sizeof f->schedule, "%s%s%s", here ? here : "", here ? "/" : "", path);
	free(here);
	return (n > 0 && (size_t)n < sizeof f->schedule) || ob_fail(e, "%s: the path is too long for a schedule", path);
}

bool ob_free_request_resolve(ob_run_request *r, const ob_scene *s, ob_error *e)
{
	ob_free_settings *f = &r->free;
	ob_settings all = s->asked;
	ob_settings_overlay(&all, &r->asked);
	r->is_free = ob_setting_is_set(&r->asked, OB_SETTING_SYNC) ? r->asked.sync : all.sync || all.replay_schedule;
	if (!r->is_free)
		return !*r->of_free.text || ob_fail(e, "--%s is for --sync free", r->of_free.text);
	r->schedule_digest = digest_of(r, s);
	*f = all.free;
	const bool replays = all.replay_schedule;
	if (!resolve_schedule(r, e))
		return false;
	if (!replays && !ob_setting_is_set(&all, OB_SETTING_UPDATE_RATE))
		f->update_rate = 1 / r->run.step_length;
	f->rate_most = f->update_rate;
	for (uint32_t i = 0; i < s->objects; i++)
		f->rate_most = fmax(f->rate_most, s->object[i].update_rate);
	if (!replays && !ob_setting_is_set(&all, OB_SETTING_MAX_LAG))
		f->max_lag = isinf(r->pace) ? steps_of_lag / f->update_rate : INFINITY;
	f->pace = f->replays ? f->pace : r->pace;
	f->end = r->duration;
	f->seed = r->scene_options.has_seed ? r->scene_options.seed : s->seed;
	if (!check(r, s, e))
		return false;
	if (f->coupling == OB_COUPLING_GROUP)
		return true;
	f->heavy = r->run.solver == OB_SOLVER_GHOST;
	// as many substeps a second as the default has, and one a step at least
	r->run.tolerance = 0;
	r->run.sleeping = 0;
	if (!ob_setting_is_set(&r->asked, OB_SETTING_SUBSTEPS)) {
		const double n = rint(OB_DEFAULT_SUBSTEPS / (OB_DEFAULT_STEP * f->update_rate));
		r->run.substeps = n > 1 ? (uint32_t)n : 1;
	}
	return true;
}
