#include "paper/viewer.h"

#include <pthread.h>
#include <stdlib.h>

struct ob_viewer {
	const ob_scene *scene;
	pthread_t thread;
	pthread_mutex_t lock; // guards the following fields, up to the empty line
	pthread_cond_t drawn;
	ob_snapshot newest;
	uint64_t frames;
	bool end, failed;
	ob_error why;

	ob_snapshot shown; // the thread's own
	uint8_t *rgba;
};

static void fail(ob_viewer *v, const ob_error *why)
{
	pthread_mutex_lock(&v->lock);
	v->failed = true;
	v->why = *why;
	pthread_cond_signal(&v->drawn);
	pthread_mutex_unlock(&v->lock);
}

// Copies the newest snapshot; returns false at the end.
static bool fetch(ob_viewer *v, ob_error *e)
{
	pthread_mutex_lock(&v->lock);
	bool on = !v->end;
	bool fine = !on || ob_snapshot_copy(&v->shown, &v->newest);
	pthread_mutex_unlock(&v->lock);
	if (!fine) {
		ob_fail(e, "out of memory");
		fail(v, e);
	}
	return on && fine;
}

static void *draw(void *argument)
{
	ob_viewer *v = argument;
	ob_error e;
	ob_render_setup setup = { .width = OB_PAPER_WIDTH, .height = OB_PAPER_HEIGHT, .samples = 1 };
	ob_renderer *r = ob_renderer_create(&setup, &v->scene->look, &e);
	if (!r)
		fail(v, &e);
	while (r && fetch(v, &e)) {
		if (!ob_renderer_draw(r, NULL, &v->shown, v->shown.time, &v->scene->camera[0], v->rgba, &e)) {
			fail(v, &e);
			break;
		}
		pthread_mutex_lock(&v->lock);
		v->frames++;
		pthread_cond_signal(&v->drawn);
		pthread_mutex_unlock(&v->lock);
	}
	ob_renderer_destroy(r);
	return NULL;
}

static bool wait_for_first(ob_viewer *v)
{
	pthread_mutex_lock(&v->lock);
	while (v->frames == 0 && !v->failed)
		pthread_cond_wait(&v->drawn, &v->lock);
	bool fine = !v->failed;
	pthread_mutex_unlock(&v->lock);
	return fine;
}

static void release(ob_viewer *v)
{
	pthread_mutex_destroy(&v->lock);
	pthread_cond_destroy(&v->drawn);
	ob_snapshot_finish(&v->newest);
	ob_snapshot_finish(&v->shown);
	free(v->rgba);
	free(v);
}

ob_viewer *ob_viewer_open(const ob_scene *scene, const ob_snapshot *first, ob_error *e)
{
	ob_viewer *v = calloc(1, sizeof *v);
	if (!v) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	v->scene = scene;
	pthread_mutex_init(&v->lock, NULL);
	pthread_cond_init(&v->drawn, NULL);
	v->rgba = malloc((size_t)OB_PAPER_WIDTH * OB_PAPER_HEIGHT * 4);
	if (!v->rgba || !ob_snapshot_copy(&v->newest, first) || pthread_create(&v->thread, NULL, draw, v) != 0) {
		ob_fail(e, "out of memory");
		release(v);
		return NULL;
	}
	if (!wait_for_first(v)) {
		ob_viewer_close(v, e);
		return NULL;
	}
	return v;
}

bool ob_viewer_show(ob_viewer *v, const ob_snapshot *now)
{
	pthread_mutex_lock(&v->lock);
	bool fine = ob_snapshot_copy(&v->newest, now);
	pthread_mutex_unlock(&v->lock);
	return fine;
}

uint64_t ob_viewer_frames(ob_viewer *v)
{
	pthread_mutex_lock(&v->lock);
	uint64_t n = v->frames;
	pthread_mutex_unlock(&v->lock);
	return n;
}

bool ob_viewer_close(ob_viewer *v, ob_error *e)
{
	pthread_mutex_lock(&v->lock);
	v->end = true;
	pthread_mutex_unlock(&v->lock);
	pthread_join(v->thread, NULL);
	bool fine = !v->failed;
	if (!fine && e)
		*e = v->why;
	release(v);
	return fine;
}
