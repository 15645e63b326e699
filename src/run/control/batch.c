// Steps of several runs at once, which threads share.
#include <ob/control.h>
#include <ob/joint.h>

#include <pthread.h>
#include <stdatomic.h>

typedef struct batch {
	ob_run_step *run; // [runs]
	size_t runs;
	uint64_t steps;
	atomic_size_t next; // the first that no thread has taken
} batch;

static bool carry_out(ob_run_step *r, uint64_t steps, ob_error *e)
{
	ob_controller *c = r->controller;
	if (r->snapshot && !ob_controller_restore(c, r->snapshot, e))
		return false;
	if (steps + r->motors + r->forces &&
	    !ob_controller_step_with(c, steps, r->motor, r->motors, r->force, r->forces, e))
		return false;
	if (r->joints && !ob_universe_get_joint_values(r->universe, r->joint, r->joints, r->values))
		return ob_fail(e, "a joint that is read has ended, has broken, or has no axis");
	if (r->objects)
		r->objects = ob_universe_get_states(r->universe, &r->states, r->objects);
	return true;
}

static void *work(void *argument)
{
	batch *b = argument;
	for (size_t i; (i = atomic_fetch_add(&b->next, 1)) < b->runs;)
		b->run[i].failed = !carry_out(&b->run[i], b->steps, &b->run[i].error);
	return NULL;
}

bool ob_controller_step_all(ob_run_step *run, size_t n, uint64_t steps, unsigned threads, ob_error *e)
{
	enum { MOST = 256 };
	batch b = { .run = run, .runs = n, .steps = steps };
	pthread_t thread[MOST];
	unsigned begun = 0;
	while (begun < MOST && begun + 1 < threads && begun + 1 < n &&
	       pthread_create(&thread[begun], NULL, work, &b) == 0)
		begun++;
	work(&b);
	while (begun)
		pthread_join(thread[--begun], NULL);
	for (size_t i = 0; i < n; i++)
		if (run[i].failed)
			return ob_fail(e, "run %zu: %s", i, run[i].error.text);
	return true;
}
