// obsim run --replay: frames of a record.
#include <inttypes.h>
#include <signal.h>
#include <string.h>

#include "base/interrupt.h"
#include "cli/capture.h"
#include "cli/command.h"
#include "record/recording.h"

typedef struct drawing {
	ob_replay_request request;
	ob_recording *recording;
	ob_capture *capture;
	ob_snapshot before; // previous state
} drawing;

// Draws as many frames as the run did, as far as its states go. A state counts as a step of the run, so that frames
// between two states are drawn from both.
static bool draw_all(drawing *d, ob_error *e)
{
	bool ended = false;
	uint64_t shown = 0;
	for (;;) {
		const ob_snapshot *now = ob_recording_state(d->recording);
		if (ob_interrupt_came())
			return ob_fail(e, "interrupted: the files hold what was done so far");
		if (shown > 0 && ob_capture_need(d->capture, now->step) == UINT64_MAX)
			return true;
		if (shown > 0 && !ob_snapshot_copy(&d->before, now))
			return ob_fail(e, "no memory for a state of %u objects", now->count);
		if (!ob_recording_next(d->recording, &ended, e))
			return ended;
		if (!ob_capture_show(d->capture, shown > 0 ? &d->before : NULL, ob_recording_state(d->recording), e))
			return false;
		shown++;
	}
}

static double duration_of(const drawing *d)
{
	const double asked = d->request.duration;
	return asked > 0 ? asked : ob_recording_get_info(d->recording)->scene.duration;
}

static int carry_out(drawing *d)
{
	const ob_recording_info *i = ob_recording_get_info(d->recording);
	const ob_frames_request *f = &d->request.frames;
	double duration = duration_of(d);
	ob_error e = { "" }, e_close;
	d->capture = ob_capture_open(f, &i->scene, duration, i->interval, i->first, NULL, &e);
	if (!d->capture)
		return ob_command_fail(OB_EXIT_FAILED, e.text);
	bool drawn = draw_all(d, &e);
	uint64_t frames = ob_capture_frames(d->capture);
	bool closed = ob_capture_close(d->capture, &e_close);
	if (!drawn || !closed)
		return ob_command_fail(OB_EXIT_FAILED, drawn ? e_close.text : e.text);
	bool piped = f->raw && strcmp(f->raw, "-") == 0;
	fprintf(piped ? stderr : stdout, "%s: %" PRIu64 " frame%s, %g to %g s, as recorded by obsim %s (commit %s)\n",
		i->scene.title, frames, frames == 1 ? "" : "s", i->begin, fmin(i->end, duration), i->version,
		i->commit);
	return OB_EXIT_OK;
}

int ob_command_draw_replay(const ob_arguments *a)
{
	drawing d = { 0 };
	ob_error e;
	if (!ob_request_read_replay(&d.request, a, &e) || !(d.recording = ob_recording_open(d.request.record, &e)))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	int code;
	const ob_scene *scene = &ob_recording_get_info(d.recording)->scene;
	if (!ob_request_check_frames(&d.request.frames, scene, duration_of(&d), &e)) {
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	} else {
		signal(SIGPIPE, SIG_IGN); // a reader that leaves is an error of the sink, with a message
		ob_interrupt_watch();
		code = carry_out(&d);
		ob_interrupt_release();
	}
	ob_recording_close(d.recording);
	ob_snapshot_finish(&d.before);
	return code;
}
