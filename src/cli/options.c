#include "cli/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/spelling.h"
#include "cli/output.h"
#include "host/death.h"
#include "measure/colouring.h"
#include "settings/free.h"
#include "settings/settings.h"

enum {
	RUN = OB_COMMAND_RUN,
	COMPARE = OB_COMMAND_COMPARE,
	TOP = OB_COMMAND_TOP,
	LAB = OB_COMMAND_LAB,
	PAPER = OB_COMMAND_PAPER,
	INSPECT = OB_COMMAND_INSPECT,
	SERVE = OB_COMMAND_SERVE,
	SEND = OB_COMMAND_SEND,
	EXPORT = OB_COMMAND_EXPORT,
	CONTROL = OB_COMMAND_CONTROL,
	SCENES = OB_COMMAND_SCENES,
	IMPORT = OB_COMMAND_IMPORT,
	STEPPED = RUN | SERVE | CONTROL
};

const ob_option ob_option_table[OB_OPTIONS] = {
	[OB_OPTION_DEFINE] = { "The scene", "define", "NAME=VALUE", "set a parameter of the scene", STEPPED | COMPARE,
			       'D' },
	[OB_OPTION_VARY] = { NULL, "vary", "NAME=VALUE,..", "compare at each of these values of a parameter", COMPARE,
			     0 },
	[OB_OPTION_DURATION] = { NULL, "duration", "S", "simulated seconds (the scene says how many)",
				 STEPPED | COMPARE, 0 },
	[OB_OPTION_STEP] = { NULL, "step", "H", "seconds a step, as .01 or 1/60 (the scene's)", STEPPED | COMPARE, 0 },
	[OB_OPTION_SEED] = { NULL, "seed", "N", "seed of the scene's random numbers (the scene's)", STEPPED | COMPARE,
			     0 },

	[OB_OPTION_ARCH] = { "How it runs", "arch", OB_ARCHITECTURE_NAMES,
			     "one simulator per object, or one ODE world that holds all (obs)", STEPPED, 0 },
	[OB_OPTION_ISOLATION] = { NULL, "isolation", "thread|process", "what a worker is (thread)", STEPPED, 0 },
	[OB_OPTION_WORKERS] = { NULL, "workers", "N|objects",
				"workers in the pool, or one for each object (one per core)", STEPPED | COMPARE, 0 },
	[OB_OPTION_HARDEN] = { NULL, "harden", "[=LIST]",
			       "processes that can write their own results alone, and do little else",
			       STEPPED | COMPARE, 0 },
	[OB_OPTION_TOLERANCE] = { NULL, "tolerance", "LENGTH|P%",
				  "error that objects that touch may reach, as .5mm or .1% of the thinnest",
				  STEPPED | COMPARE, 0 },
	[OB_OPTION_STRICT] = { NULL, "strict", NULL, "exit with 1 where the tolerance is missed, or a script fails",
			       RUN, 0 },
	[OB_OPTION_VERIFY] = { NULL, "verify", NULL,
			       "solve a sample of steps again with 512 substeps, and print the errors", RUN, 0 },
	[OB_OPTION_SUBSTEPS] = { NULL, "substeps", "N", "substeps a step (the scene's; monolith: 1)", STEPPED | COMPARE,
				 0 },
	[OB_OPTION_ITERATIONS] = { NULL, "iterations", "N",
				   "of the contact solver a substep (the scene's; monolith: 20, 0 = exact)",
				   STEPPED | COMPARE, 0 },
	[OB_OPTION_SOLVER] = { NULL, "solver", OB_SOLVER_NAMES, "how contacts are solved (the scene's)",
			       STEPPED | COMPARE, 0 },
	[OB_OPTION_LAG] = { NULL, "lag", "K", "lagged: iterations that a partner's state is late (1)",
			    STEPPED | COMPARE, 0 },
	[OB_OPTION_INTEGRATOR] = { NULL, "integrator", OB_INTEGRATOR_NAMES,
				   "free motion in closed form, or by ODE's stepper (the scene's)", STEPPED | COMPARE,
				   0 },
	[OB_OPTION_SLEEPING] = { NULL, "sleeping", OB_SWITCH_NAMES, "whether what rests may sleep (the scene's)",
				 STEPPED | COMPARE, 0 },
	[OB_OPTION_NARROW] = { NULL, "narrow", OB_NARROW_PHASE_NAMES,
			       "objects touch as they are, or as boxes along the axes (obb)", STEPPED | COMPARE, 0 },
	[OB_OPTION_LOAD] = { NULL, "load", "N", "add up 1 to N in each test of two boxes (0)", STEPPED | COMPARE, 0 },
	[OB_OPTION_PATIENCE] = { NULL, "patience", "S", "seconds that a step may take until it counts as stalled (60)",
				 STEPPED | EXPORT, 0 },
	[OB_OPTION_ON_DEATH] = { NULL, "on-death", OB_ON_DEATH_NAMES,
				 "what a death or failure does: restart, freeze, end, or keep what can be "
				 "(restart)",
				 STEPPED, 0 },
	[OB_OPTION_RESTARTS] = { NULL, "restarts", "N/S",
				 "end the run at more than N deaths within S seconds (no limit)", STEPPED, 0 },
	[OB_OPTION_NAME] = { NULL, "name", "NAME", "name of the universe, for obsim top (obsim-PID)", STEPPED, 0 },

	[OB_OPTION_PACE] = { NULL, "pace", "realtime|RATE|max", "simulated seconds a second of the clock (max)",
			     RUN | SERVE, 0 },

	[OB_OPTION_SYNC] = { NULL, "sync", OB_SYNC_NAMES "|lockstep,free",
			     "all step together, or each at its own times (the scene's)", RUN | SERVE | COMPARE, 0 },
	[OB_OPTION_UPDATE_RATE] = { NULL, "update-rate", "HZ", "free: steps of a simulator a second (the scene's)",
				    RUN | SERVE, 0 },
	[OB_OPTION_COUPLING] = { NULL, "coupling", OB_COUPLING_NAMES,
				 "free: who computes an impulse: each its own, or one that mails it (own)", RUN | SERVE,
				 0 },
	[OB_OPTION_MAX_LAG] = { NULL, "max-lag", "S|none",
				"free: seconds ahead of a neighbour (pace max: two steps; else none)", RUN | SERVE, 0 },
	[OB_OPTION_JITTER] = { NULL, "jitter", "P", "free: share by which lengths of steps vary (0)", RUN | SERVE, 0 },
	[OB_OPTION_DELAY] = { NULL, "delay", "S", "free: seconds until a publication is seen (0)", RUN | SERVE, 0 },
	[OB_OPTION_RECORD_SCHEDULE] = { NULL, "record-schedule", "FILE",
					"free: record who stepped when, and read what, to repeat the run", RUN, 0 },
	[OB_OPTION_REPLAY_SCHEDULE] = { NULL, "replay-schedule", "FILE", "repeat a free run to the bit, in one thread",
					RUN, 0 },

	[OB_OPTION_LIVE] = { "The server", "live", NULL,
			     "one world, threads and processes, or both ways, side by side on one page", COMPARE, 0 },
	[OB_OPTION_LISTEN] = { "The server", "listen", "ADDR:PORT",
			       "where viewers come to; port 0 is a free one (127.0.0.1:8080)", SERVE | COMPARE, 0 },
	[OB_OPTION_PAUSED] = { NULL, "paused", NULL, "stand still until a viewer lets it run", SERVE, 0 },
	[OB_OPTION_READONLY] = { NULL, "readonly", NULL, "viewers may look, and change nothing", SERVE, 0 },
	[OB_OPTION_VIEWERS] = { NULL, "viewers", "N", "viewers at a time (64)", SERVE, 0 },
	[OB_OPTION_ROOM] = { NULL, "room", "N", "objects that viewers may add (1000)", SERVE | CONTROL, 0 },

	[OB_OPTION_FRAMES] = { "Frames", "frames", "DIR", "write DIR/frame-000000.png and so on", RUN, 0 },
	[OB_OPTION_VIDEO] = { NULL, "video", "FILE", "write a video through ffmpeg", RUN, 0 },
	[OB_OPTION_RAW] = { NULL, "raw", "FILE", "write raw rgb24 frames; - = standard output", RUN, 0 },
	[OB_OPTION_FPS] = { NULL, "fps", "F", "frames per simulated second (60)", RUN, 0 },
	[OB_OPTION_STILL] = { NULL, "still", "S,..", "write frames of these times (s) alone", RUN, 0 },
	[OB_OPTION_SIZE] = { NULL, "size", "WxH", "pixels (1280x720)", RUN, 0 },
	[OB_OPTION_QUALITY] = { NULL, "quality", "draft|fine",
				"fine: soft shadows, light of the sky; takes some 20 times as long (draft)", RUN, 0 },
	[OB_OPTION_SAMPLES] = { NULL, "samples", "N", "samples a pixel (draft: 4 on a GPU; fine: 16)", RUN, 0 },
	[OB_OPTION_CAMERA] = { NULL, "camera", "NAME", "which of the scene's cameras (the first)", RUN, 0 },
	[OB_OPTION_OVERLAY] = { NULL, "overlay", "LIST",
				"draw over it: aabb, contacts, joints, reads, simulators, caption; several with commas",
				RUN, 0 },
	[OB_OPTION_COLOUR_BY] = { NULL, "colour-by", OB_COLOUR_KEY_NAMES,
				  "colour objects by who simulates them, and how (own)", RUN, 0 },
	[OB_OPTION_GPU] = { NULL, "gpu", "WHICH", "surfaceless, or the number of a GPU (the first that works)", RUN,
			    0 },

	[OB_OPTION_RECORD] = { "What is kept", "record", "FILE",
			       "trajectories, and all that it takes to draw them again, as HDF5", RUN | SERVE, 0 },
	[OB_OPTION_SERIES] = { NULL, "series", "FILE", "energy, momentum, penetration of each step, as CSV", RUN, 0 },
	[OB_OPTION_REPORT] = { NULL, "report", "short|full", "five lines, or all that was measured (short)", RUN, 0 },
	[OB_OPTION_JSON] = { NULL, "json", "FILE", "the report, as JSON; - = standard output", RUN | COMPARE, 0 },
	[OB_OPTION_MEASURE] = { NULL, "measure", "step|profile|end",
				"each step, where the time goes, or neither (step)", RUN, 0 },
	[OB_OPTION_EXPLAIN] = { NULL, "explain", NULL,
				"what was modelled, what was left out and why, and what each part cost", RUN, 0 },
	[OB_OPTION_TRACE] = { NULL, "trace", "FILE", "what each worker did when, for ui.perfetto.dev", RUN, 0 },

	[OB_OPTION_CHECKPOINT] = { NULL, "checkpoint", "FILE",
				   "what the run needs to go on, replaced as it goes, and at its end", RUN | SERVE, 0 },
	[OB_OPTION_EVERY] = { NULL, "every", "S", "simulated seconds from one checkpoint to the next (1)", RUN, 0 },
	[OB_OPTION_RESUME] = { NULL, "resume", "FILE", "go on from a checkpoint, instead of a scene", RUN | CONTROL,
			       0 },
	[OB_OPTION_REPLAY] = { NULL, "replay", "FILE", "show what was recorded, instead of a scene", RUN | SERVE, 0 },

	[OB_OPTION_LOG_REQUESTS] = { NULL, "log-requests", "FILE",
				     "what viewers and programs ask for, and the state every second", SERVE, 0 },
	[OB_OPTION_REPLAY_REQUESTS] = { NULL, "replay-requests", "FILE",
					"carry out what serve has logged, and compare states", RUN, 0 },

	[OB_OPTION_FAULT] = { "To test with", "fault", "KINDS:p=P,..",
			      "simulators that kill, stop, exit ..., as kill+exit:p=.001,seed=7", RUN, 0 },
	[OB_OPTION_CHECK] = { NULL, "check", NULL,
			      "check what simulators share after each step; exit with 4 where it is wrong", STEPPED,
			      0 },

	[OB_OPTION_LIST] = { "What is run", "list", NULL, "print the cases and end", LAB, 0 },
	[OB_OPTION_QUICK] = { NULL, "quick", NULL, "only a quick subset", LAB | PAPER, 0 },
	[OB_OPTION_OBJECTS] = { NULL, "objects", "N", "boxes in each experiment (64)", PAPER, 0 },
	[OB_OPTION_ENGINES] = { NULL, "engines", "LIST", "engines by name, with commas (all)", LAB, 0 },
	[OB_OPTION_SWEEP] = { NULL, "sweep", "LISTS|none",
			      "as substeps=1,2,4,tolerance=5mm,.5mm (what suits each engine)", LAB, 0 },
	[OB_OPTION_AUDIT] = { NULL, "audit", NULL, "whether obsim's errors fall with its tolerance and its substeps",
			      LAB, 0 },
	[OB_OPTION_REPEATS] = { NULL, "repeats", "N", "runs of each; times are their medians (1)",
				LAB | COMPARE | PAPER, 0 },
	[OB_OPTION_SEEDS] = { NULL, "seeds", "N", "seeds, from the scene's on; repeats of each (1)", COMPARE, 0 },
	[OB_OPTION_LIMIT] = { NULL, "limit", "S", "seconds of CPU that a run may take (150)", LAB, 0 },
	[OB_OPTION_OUT] = { "What comes of it", "out", "DIR", "folder for results, diagrams, report (none)",
			    LAB | PAPER | COMPARE | IMPORT, 0 },
	[OB_OPTION_FRESH] = { NULL, "fresh", NULL, "run again what DIR has already", LAB | PAPER | COMPARE, 0 },
	[OB_OPTION_JSON_OUT] = { NULL, "json", NULL, "print it as JSON", LAB | PAPER | INSPECT, 0 },
	[OB_OPTION_CHECK_TARGETS] = { NULL, "check", NULL, "exit with 3 when obsim misses a target", LAB, 0 },

	[OB_OPTION_ONCE] = { "The view", "once", NULL, "print once, for pipes, and end", TOP, 0 },
	[OB_OPTION_INTERVAL] = { NULL, "interval", "S", "seconds between looks (1)", TOP, 0 },

	[OB_OPTION_HELP] = { "Other", "help", NULL, "print this and end",
			     STEPPED | COMPARE | TOP | LAB | PAPER | INSPECT | SEND | EXPORT | SCENES | IMPORT, 'h' },
};

static int unknown(const ob_arguments *a, const char *name, ob_error *e)
{
	ob_spelling s = ob_spelling_start(name);
	for (int i = 0; i < OB_OPTIONS; i++) {
		if (ob_option_table[i].commands & a->command)
			ob_spelling_offer(&s, ob_option_table[i].name);
	}
	if (s.best)
		return ob_fail(e, "unknown option --%s: did you mean --%s?", name, s.best);
	return ob_fail(e, "unknown option --%s: --help lists the options", name);
}

// Checks a value against an argument like "obs|monolith"; upper case in that allows anything. Replaces a word of
// earlier versions by the current one.
static bool check_choice(const ob_option *o, const char **value, ob_error *e)
{
	if (!o->argument || !strchr(o->argument, '|') || strpbrk(o->argument, "ABCDEFGHIJKLMNOPQRSTUVWXYZ"))
		return true;
	const char *now = ob_setting_renamed(*value);
	char words[64];
	snprintf(words, sizeof words, "%s", o->argument);
	ob_spelling s = ob_spelling_start(*value);
	char *rest = words;
	for (char *word; (word = strsep(&rest, "|"));) {
		if (strcmp(word, *value) == 0)
			return true;
		if (now && strcmp(word, now) == 0) {
			ob_log_note("--%s %s is now called --%s %s", o->name, *value, o->name, now);
			*value = now;
			return true;
		}
		ob_spelling_offer(&s, word);
	}
	if (s.best)
		return ob_fail(e, "--%s %s: did you mean %s? (%s)", o->name, *value, s.best, o->argument);
	return ob_fail(e, "--%s %s: expected one of %s", o->name, *value, o->argument);
}

static bool add_define(ob_arguments *a, const char *text, ob_error *e)
{
	size_t name = strcspn(text, "=");
	if (!text[name] || name == 0)
		return ob_fail(e, "-D %s: expected NAME=VALUE, as in -D n=100", text);
	for (const char **other = a->define; *other; other++) {
		if (strncmp(*other, text, name + 1) == 0)
			return ob_fail(e, "-D %.*s is given twice: %s and %s", (int)name, text, *other, text);
	}
	a->define[a->defines++] = text;
	return true;
}

static bool is_optional(const ob_option *o)
{
	return o->argument && o->argument[0] == '[';
}

static bool set(ob_arguments *a, ob_option_id id, const char *value, ob_error *e)
{
	const ob_option *o = &ob_option_table[id];
	if (id == OB_OPTION_DEFINE)
		return add_define(a, value, e);
	if (a->value[id])
		return ob_fail(e, "--%s is given twice", o->name);
	if (o->argument && !*value && !is_optional(o))
		return ob_fail(e, "--%s needs a value: --%s %s", o->name, o->name, o->argument);
	if (!check_choice(o, &value, e) || !ob_output_check(id, o->name, value, e))
		return false;
	a->value[id] = value;
	return true;
}

static int find_long(const ob_arguments *a, const char *name, size_t length)
{
	for (int i = 0; i < OB_OPTIONS; i++) {
		const ob_option *o = &ob_option_table[i];
		if ((o->commands & a->command) && strncmp(o->name, name, length) == 0 && !o->name[length])
			return i;
	}
	return -1;
}

static int find_short(const ob_arguments *a, char letter)
{
	for (int i = 0; i < OB_OPTIONS; i++) {
		if ((ob_option_table[i].commands & a->command) && ob_option_table[i].letter == letter)
			return i;
	}
	return -1;
}

// Parses one option at *at; moves *at past a value in an argument of its own.
static bool take_option(ob_arguments *a, int argc, char **argv, int *at, ob_error *e)
{
	const char *text = argv[*at], *value = NULL;
	int id;
	if (text[1] == '-') {
		size_t length = strcspn(text + 2, "=");
		char name[64];
		snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), text + 2);
		id = find_long(a, text + 2, length);
		const char *now = id < 0 ? ob_setting_renamed(name) : NULL;
		if (now && (id = find_long(a, now, strlen(now))) >= 0)
			ob_log_note("--%s is now called --%s", name, now);
		if (id < 0)
			return unknown(a, name, e);
		value = text[2 + length] ? text + 2 + length + 1 : NULL;
	} else {
		id = find_short(a, text[1]);
		if (id < 0)
			return find_long(a, text + 1, strlen(text + 1)) >= 0
				       ? ob_fail(e, "unknown option %s: did you mean -%s?", text, text)
				       : ob_fail(e, "unknown option %s: --help lists the options", text);
		value = text[2] ? text + 2 : NULL;
	}
	const ob_option *o = &ob_option_table[id];
	if (is_optional(o))
		return value && !*value ? ob_fail(e, "--%s=: expected a list behind it, or leave the = away", o->name)
					: set(a, id, value ? value : "", e);
	if (!o->argument)
		return value ? ob_fail(e, "--%s takes no value", o->name) : set(a, id, "", e);
	if (!value) {
		if (*at + 1 >= argc || strncmp(argv[*at + 1], "--", 2) == 0)
			return ob_fail(e, "--%s needs a value: --%s %s", o->name, o->name, o->argument);
		value = argv[++*at];
	}
	return set(a, id, value, e);
}

// True for -1 and -.5, which are values: no option is a digit.
static bool is_negative(const char *text)
{
	return text[0] == '-' && strchr("0123456789", text[1 + (text[1] == '.')]) && text[1 + (text[1] == '.')];
}

bool ob_options_parse(ob_arguments *a, ob_command_bit command, int argc, char **argv, ob_error *e)
{
	*a = (ob_arguments){ .command = command };
	a->define = calloc((size_t)argc + 1, sizeof *a->define);
	a->operands = calloc((size_t)argc + 1, sizeof *a->operands);
	if (!a->define || !a->operands)
		return ob_fail(e, "out of memory");
	bool only_operands = false;
	int operands = 0;
	for (int i = 0; i < argc; i++) {
		if (!only_operands && strcmp(argv[i], "--") == 0) {
			only_operands = true;
		} else if (!only_operands && argv[i][0] == '-' && argv[i][1] && !is_negative(argv[i])) {
			if (!take_option(a, argc, argv, &i, e))
				return false;
		} else if (a->operand && command != OB_COMMAND_LAB && command != OB_COMMAND_SEND &&
			   !(command == OB_COMMAND_EXPORT && operands < 2)) {
			return ob_fail(e, "unexpected '%s' after '%s': one %s at a time", argv[i], a->operand,
				       command == OB_COMMAND_TOP       ? "universe"
				       : command == OB_COMMAND_INSPECT ? "checkpoint"
				       : command == OB_COMMAND_IMPORT  ? "model"
				       : command == OB_COMMAND_EXPORT  ? "record and one page"
								       : "scene");
		} else {
			a->operands[operands++] = argv[i];
			a->operand = a->operands[0];
		}
	}
	return true;
}

void ob_options_finish(ob_arguments *a)
{
	free(a->define);
	free(a->operands);
	*a = (ob_arguments){ 0 };
}

bool ob_options_define(ob_arguments *own, const ob_arguments *a, const char *define, ob_error *e)
{
	*own = *a;
	own->define = calloc(a->defines + 2, sizeof *own->define);
	if (!own->define)
		return ob_fail(e, "out of memory");
	if (a->defines)
		memcpy(own->define, a->define, a->defines * sizeof *own->define);
	if (*define)
		own->define[own->defines++] = define;
	return true;
}

static const struct {
	ob_command_bit command;
	const char *usage, *what;
} commands[] = {
	{ OB_COMMAND_RUN, "obsim run SCENE.lua [OPTION ...]",
	  "Runs a scene, each object a simulator of its own, and reports speed and error." },
	{ OB_COMMAND_SERVE, "obsim serve SCENE.lua [OPTION ...]",
	  "Runs a scene that people look at, and change, from their browsers." },
	{ OB_COMMAND_CONTROL, "obsim control SCENE.lua [OPTION ...]",
	  "Runs a scene that a program leads step by step: Python, or C." },
	{ OB_COMMAND_SCENES, "obsim scenes", "Lists the scenes that come with obsim: obsim run NAME." },
	{ OB_COMMAND_COMPARE, "obsim compare SCENE.lua [OPTION ...]",
	  "Runs a scene as one world, as threads and as processes, and prints one table." },
	{ OB_COMMAND_TOP, "obsim top [NAME] [OPTION ...]",
	  "Looks into a running universe (the newest, unless named) from another terminal." },
	{ OB_COMMAND_SEND, "obsim send NAME REQUEST ...", "Changes objects of a running universe, or sends messages." },
	{ OB_COMMAND_EXPORT, "obsim export FILE.h5 PAGE.html [OPTION ...]",
	  "Makes a page of what was recorded, for any browser, or MCAP (FILE.mcap)." },
	{ OB_COMMAND_IMPORT, "obsim import FILE [--out DIR]",
	  "Makes a scene of a robot, or another model, in MJCF or URDF." },
	{ OB_COMMAND_INSPECT, "obsim inspect FILE [OPTION ...]",
	  "Says what a checkpoint holds, and whether it is whole." },
	{ OB_COMMAND_LAB, "obsim lab [CASE ...] [OPTION ...]",
	  "Runs hard cases with several engines: error against target and against cost." },
	{ OB_COMMAND_PAPER, "obsim paper [OPTION ...]",
	  "Repeats the experiment of the paper behind obsim, and judges its claims." },
};

// Meanings of an option to one command, where another has it with other words.
static const struct {
	ob_option_id id;
	unsigned command;
	const char *help;
} own_help[] = {
	{ OB_OPTION_PATIENCE, EXPORT, "seconds that the page may take to make (10)" },
	{ OB_OPTION_PACE, SERVE, "simulated seconds a second of the clock (realtime)" },
	{ OB_OPTION_ISOLATION, SERVE, "what a worker is (process)" },
	{ OB_OPTION_ON_DEATH, SERVE, "what a death or failure does: restart, freeze, end, or keep what can be (keep)" },
	{ OB_OPTION_CHECKPOINT, SERVE, "where operators save what the run needs to go on" },
	{ OB_OPTION_ROOM, CONTROL, "objects that the program may add (1000)" },
	{ OB_OPTION_REPEATS, COMPARE, "runs of each; times are their medians (3)" },
	{ OB_OPTION_REPEATS, PAPER, "runs of each; times are their medians (15)" },
	{ OB_OPTION_OUT, LAB, "folder for results, diagrams, report (obsim-lab)" },
	{ OB_OPTION_OUT, PAPER, "folder for results, diagrams, report (obsim-paper)" },
	{ OB_OPTION_OUT, IMPORT, "folder for the scene and its looks (the scene alone, to standard output)" },
};

static const char *help_of(ob_option_id id, ob_command_bit command)
{
	for (size_t i = 0; i < sizeof own_help / sizeof *own_help; i++)
		if (own_help[i].id == id && own_help[i].command == command)
			return own_help[i].help;
	return ob_option_table[id].help;
}

void ob_options_help(FILE *f, ob_command_bit command)
{
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		if (commands[i].command == command)
			fprintf(f, "Usage: %s\n%s\n", commands[i].usage, commands[i].what);
	}
	const char *group = NULL, *shown = NULL;
	for (int i = 0; i < OB_OPTIONS; i++) {
		const ob_option *o = &ob_option_table[i];
		group = o->group ? o->group : group;
		if (!(o->commands & command))
			continue;
		if (group != shown)
			fprintf(f, "\n%s:\n", group);
		shown = group;
		char left[128];
		const int width = snprintf(left, sizeof left, "%s%c%s--%s%s%s", o->letter ? "-" : " ",
					   o->letter ? o->letter : ' ', o->letter ? ", " : "  ", o->name,
					   is_optional(o) ? "" : " ", o->argument ? o->argument : "");
		fprintf(f, "  %-32s%s%s\n", left, width > 32 ? "\n                                   " : " ",
			help_of((ob_option_id)i, command));
	}
	if (command == OB_COMMAND_TOP)
		fputs("\nKeys: q quits, w shows workers or objects, s sorts by id or speed, arrows and page keys "
		      "scroll.\n",
		      f);
	if (command == OB_COMMAND_RUN)
		fputs("\nobsim run --resume FILE [OPTION ...] goes on with the scene and the settings of the "
		      "checkpoint.\nobsim run --replay FILE.h5 --frames DIR draws what was recorded, with the options "
		      "under Frames.\n",
		      f);
	if (command == OB_COMMAND_SERVE)
		fputs("\nobsim serve --replay FILE.h5 [--listen ADDR:PORT] shows what was recorded, to each viewer at "
		      "a time of "
		      "their own.\n",
		      f);
	if (command == OB_COMMAND_LAB)
		fputs("\nA CASE is a name, a row of the table (14), or the start or pattern of names (stack, '*-10'); "
		      "without one, all.\nThe same command goes on where it was interrupted.\n",
		      f);
	fprintf(f, "\nDefaults stand in brackets. Exit: 0 done, 1 failed or interrupted, 2 wrong usage%s.\n",
		command == OB_COMMAND_LAB       ? ", 3 a target missed"
		: command & STEPPED             ? " or scene, 4 --check found a fault"
		: command == OB_COMMAND_INSPECT ? ", or no whole checkpoint"
		: command == OB_COMMAND_IMPORT  ? ", or no model"
		: command == OB_COMMAND_EXPORT  ? ", or no whole record"
						: " or scene");
}

void ob_options_overview(FILE *f)
{
	fputs("Usage: obsim COMMAND [OPTION ...]\n"
	      "Emulates object-based simulators: every object of a scene is a simulator of its own.\n\n",
	      f);
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
		fprintf(f, "  %-38s %s\n", commands[i].usage, commands[i].what);
	fputs("\n  obsim COMMAND --help                   The options of a command.\n"
	      "  obsim --version                        Version, commit and libraries.\n\n"
	      "Try: obsim run falling_boxes -D n=100\n",
	      f);
}
