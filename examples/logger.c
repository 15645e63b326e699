// Logs a running universe as CSV, a line for each object and step: logger NAME STEPS. Steps that pass while it writes are
// left out.
// cc logger.c $(pkg-config --cflags --libs obsim) -o logger
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include <ob/universe.h>

typedef struct states {
	uint32_t *id;
	double *position, *velocity;
	size_t max;
} states;

// Makes room for n objects.
static bool reserve(states *s, size_t n)
{
	uint32_t *id = realloc(s->id, n * sizeof *id);
	s->id = id ? id : s->id;
	double *p = realloc(s->position, n * 3 * sizeof *p);
	s->position = p ? p : s->position;
	double *v = realloc(s->velocity, n * 3 * sizeof *v);
	s->velocity = v ? v : s->velocity;
	s->max = id && p && v ? n : s->max;
	return id && p && v;
}

static bool log_step(const ob_universe *u, states *s)
{
	ob_universe_info info;
	size_t n;
	ob_universe_get_info(u, &info);
	for (;;) {
		const ob_state_arrays arrays = { .id = s->id, .position = s->position, .velocity = s->velocity };
		n = ob_universe_get_states(u, &arrays, s->max);
		if (n <= s->max)
			break;
		if (!reserve(s, n))
			return false;
	}
	for (size_t i = 0; i < n; i++) {
		const double *p = s->position + 3 * i, *v = s->velocity + 3 * i;
		printf("%" PRIu64 ",%.6f,%" PRIu32 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", info.step, info.time, s->id[i],
		       p[0], p[1], p[2], v[0], v[1], v[2]);
	}
	return true;
}

int main(int argc, char **argv)
{
	ob_error e = { "usage: logger NAME STEPS" };
	ob_universe *u = argc == 3 ? ob_universe_attach(argv[1], &e) : NULL;
	if (!u) {
		fprintf(stderr, "logger: %s\n", e.text);
		return 1;
	}
	ob_universe_info info;
	states s = { 0 };
	ob_universe_get_info(u, &info);
	const uint64_t end = info.step + strtoull(argv[2], NULL, 10);
	setvbuf(stdout, NULL, _IOLBF, 0); // a reader of a pipe gets each line at once
	puts("step,time,id,x,y,z,vx,vy,vz");
	bool fine = log_step(u, &s);
	while (fine && info.step < end && ob_universe_is_hosted(u)) {
		if (!ob_universe_wait(u, info.step + 1, 1) && info.state != OB_UNIVERSE_RUNNING)
			break; // no further step comes
		const uint64_t before = info.step;
		ob_universe_get_info(u, &info);
		fine = info.step == before || log_step(u, &s);
	}
	free(s.id);
	free(s.position);
	free(s.velocity);
	ob_universe_detach(u);
	return fine ? 0 : 1;
}
