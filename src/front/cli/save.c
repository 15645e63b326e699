#include "cli/save.h"

#include "checkpoint/saved_run.h"
#include "cli/output.h"
#include "cli/version.h"

bool ob_save_led_run(const ob_run_request *r, const ob_scene *s, ob_host *h, const char *path, ob_error *e)
{
	ob_checkpoint_file f = { 0 };
	ob_saved_run now = { .scene = r->scene,
			     .text = s->text,
			     .text_size = s->text_size,
			     .options = r->scene_options,
			     .duration = r->duration,
			     .settings = r->run };
	now.settings.timed = now.settings.freezes = now.settings.budget = now.settings.verify = 0;
	now.settings.fault = (ob_fault_plan){ 0 };
	bool fine = !r->run.monolith || ob_fail(e, "the one ODE world cannot be saved: take object simulators");
	fine = fine && ob_output_fits("save", path, 0, e);
	fine = fine && ob_saved_run_make(&now, &f, h, ob_version_words, e);
	if (fine) {
		ob_checkpoint_seal(&f);
		fine = ob_checkpoint_write(&f, path, e);
	}
	ob_checkpoint_finish(&f);
	return fine;
}
