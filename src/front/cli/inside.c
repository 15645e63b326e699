// The part that runs a universe within a program (control/inside.h): a led run of which the caller is the only worker.
#include "control/inside.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/led_run.h"
#include "table/table.h"

struct ob_inside_run {
	char **word; // [words]
	size_t words;
	ob_arguments arguments;
	char name[OB_NAME_MAX];
	pid_t owner; // process: a child that is forked has a copy
	ob_led_run led;
	ob_control_answer failed; // its error: why the run has ended; "" = it goes on
};

static void end(ob_inside_run *r)
{
	if (getpid() != r->owner) // the universe is still its parent's
		return;
	ob_led_run_finish(&r->led);
	ob_options_finish(&r->arguments);
	for (size_t i = 0; i < r->words; i++)
		free(r->word[i]);
	free(r->word);
	free(r);
}

// The program's words may go before the run ends.
static bool keep_words(ob_inside_run *r, const char *const *words, size_t n)
{
	r->word = calloc(n + 1, sizeof *r->word);
	for (; r->word && r->words < n; r->words++)
		if (!(r->word[r->words] = strdup(words[r->words])))
			return false;
	return r->word;
}

// Each universe of a program has a name of its own.
static void name_run(ob_inside_run *r)
{
	static atomic_uint runs;
	const char **name = &r->led.q.name;
	snprintf(r->name, sizeof r->name, "inside-%d-%u", (int)getpid(), atomic_fetch_add(&runs, 1) + 1);
	*name = *name ? *name : r->name;
}

static ob_inside_run *begin(const char *const *words, size_t n, char name[OB_NAME_MAX], ob_error *e)
{
	ob_inside_run *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	r->owner = getpid();
	bool fine = keep_words(r, words, n) || ob_fail(e, "out of memory");
	fine = fine && ob_options_parse(&r->arguments, OB_COMMAND_CONTROL, (int)n, r->word, e) &&
	       ob_led_run_load(&r->led, &r->arguments, true, e);
	if (fine) {
		name_run(r);
		fine = ob_led_run_start(&r->led, e);
	}
	if (fine) {
		snprintf(name, OB_NAME_MAX, "%s", ob_universe_name(ob_host_universe(r->led.host)));
		return r;
	}
	end(r);
	return NULL;
}

static const ob_control_answer *call(ob_inside_run *r, const ob_control_packet *p, size_t bytes)
{
	ob_error e;
	if (getpid() != r->owner)
		ob_fail(&r->failed.error, "the run is inside the program that was forked: begin another");
	if (*r->failed.error.text)
		return &r->failed;
	ob_control_give(r->led.control, p, bytes);
	if (ob_led_run_go_on(&r->led, &e))
		return ob_control_answered(r->led.control);
	r->failed.error = e;
	return &r->failed;
}

OB_PART(ob_inside_part) = {
	OB_PART_HEAD(ob_inside_part),
	.open = begin,
	.call = call,
	.close = end,
};
