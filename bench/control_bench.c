// Cost of a step of the cart and pole of docs/control.md at 500 Hz, led within this program. In each step a feedback of both
// joints sets a new target of the motor; beside it the same without new targets, the same step without either, and MuJoCo's
// two integrators with the same feedback, if it is built in. All take turns; us of CPU a step, as others may load the machine.
//
//     bench_control OBSIM [ROUNDS]                 OBSIM: the program, beside which obsim-inside.so lies
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <ob/control.h>
#include <ob/joint.h>

#ifdef OB_MUJOCO_VERSION
#include <mujoco/mujoco.h>
#endif

enum { STEPS = 500, ROUNDS = 21, KINDS = 5 };
static const double step_length = 1. / 500; // s
static const char *const names[KINDS] = { "feedback and new target", "feedback, old target", "step alone",
					  "MuJoCo, Euler", "MuJoCo, Runge-Kutta" };

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static void quit(const char *why)
{
	fprintf(stderr, "bench_control: %s\n", why);
	exit(1);
}

// Rate of the cart that holds the pole up: by values and rates of foot and rail.
static double feedback(const double *foot, const double *rail)
{
	return rail[1] + step_length * (60 * foot[0] + 15 * foot[1] + 2 * rail[0] + 4 * rail[1]);
}

// ---- obsim

static const char scene[] =
	"scene { step = 1/500 }\n"
	"box { name = 'cart', size = { .4, .2, .1 }, at = { 0, 0, 1 }, mass = 2 }\n"
	"slider { 'cart', name = 'rail', axis = { 1, 0, 0 }, motor = { rate = 0, most = 100 } }\n"
	"box { name = 'pole', size = { .05, .05, 1 }, at = { 0, 0, 1.55 }, mass = .5, velocity = { .1, 0, 0 } }\n"
	"hinge { 'pole', 'cart', name = 'foot', at = { 0, 0, 1.05 }, axis = { 0, 1, 0 } }\n";

typedef struct run {
	ob_controller *controller;
	ob_universe *universe;
	uint64_t start;
} run;

static void begin_obsim(run *r)
{
	char path[] = "/tmp/bench_control.XXXXXX.lua", name[OB_NAME_MAX];
	const char *words[] = { path };
	ob_error e;
	const int fd = mkstemps(path, 4);
	FILE *f = fd < 0 ? NULL : fdopen(fd, "w");
	if (!f || fputs(scene, f) < 0 || fclose(f) != 0)
		quit("no scene can be written into /tmp");
	r->controller = ob_controller_open_inside(words, 1, name, &e);
	remove(path);
	if (!r->controller || !(r->universe = ob_universe_attach(name, &e)) ||
	    !ob_controller_snapshot(r->controller, &r->start, &e))
		quit(e.text);
}

// Steps from the start. rate: NAN without a feedback.
static void lead_obsim(run *r, bool reads, bool sets)
{
	static const uint32_t joints[] = { 1, 0 }; // foot, rail
	ob_change target = { 0 };
	double value[4];
	ob_error e;
	for (int i = 0; i < STEPS; i++) {
		if (reads && !ob_universe_get_joint_values(r->universe, joints, 2, value))
			quit("no such joint");
		if (sets)
			target.value[1] = feedback(value, value + 2);
		if (!ob_controller_step_with(r->controller, 1, &target, sets, NULL, 0, &e))
			quit(e.text);
	}
}

// ---- MuJoCo

#ifdef OB_MUJOCO_VERSION
static const char model[] =
	"<mujoco><option timestep='0.002' gravity='0 0 -9.81'/><worldbody><body name='cart' pos='0 0 1'>"
	"<joint name='rail' type='slide' axis='1 0 0'/><geom type='box' size='.2 .1 .05' mass='2' contype='0' "
	"conaffinity='0'/>"
	"<body pos='0 0 .05'><joint name='foot' type='hinge' axis='0 1 0'/>"
	"<geom type='box' size='.025 .025 .5' pos='0 0 .5' mass='.5' contype='0' "
	"conaffinity='0'/></body></body></worldbody>"
	"<actuator><velocity joint='rail' kv='1000' forcerange='-100 100' forcelimited='true'/></actuator></mujoco>";

typedef struct world {
	mjModel *model;
	mjData *data;
} world;

static void begin_mujoco(world *w)
{
	char path[] = "/tmp/bench_control.XXXXXX.xml", why[256] = "";
	const int fd = mkstemps(path, 4);
	FILE *f = fd < 0 ? NULL : fdopen(fd, "w");
	if (!f || fputs(model, f) < 0 || fclose(f) != 0)
		quit("no model can be written into /tmp");
	w->model = mj_loadXML(path, NULL, why, sizeof why);
	remove(path);
	if (!w->model)
		quit(why);
	w->data = mj_makeData(w->model);
}

static void lead_mujoco(world *w, bool runge_kutta)
{
	mjData *d = w->data;
	mj_resetData(w->model, d);
	w->model->opt.integrator = runge_kutta ? mjINT_RK4 : mjINT_EULER;
	d->qvel[0] = .1, d->qvel[1] = 0;
	for (int i = 0; i < STEPS; i++) {
		const double rail[] = { d->qpos[0], d->qvel[0] }, foot[] = { d->qpos[1], d->qvel[1] };
		d->ctrl[0] = feedback(foot, rail);
		mj_step(w->model, d);
	}
}
#endif

// ---- all

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

int main(int count, char **word)
{
	static double took[KINDS][ROUNDS];
	const int rounds = count > 2 ? atoi(word[2]) : ROUNDS;
	int kinds = 3;
	run r;
	ob_error e;
	if (count < 2 || setenv("OBSIM", word[1], 1) != 0 || rounds < 1 || rounds > ROUNDS)
		quit("call it as: bench_control OBSIM [ROUNDS, 1 to 21]");
	begin_obsim(&r);
#ifdef OB_MUJOCO_VERSION
	world w;
	begin_mujoco(&w);
	kinds = KINDS;
#endif
	for (int i = 0; i < rounds; i++)
		for (int k = 0; k < kinds; k++) {
			if (k < 3 && !ob_controller_restore(r.controller, r.start, &e))
				quit(e.text);
			const double began = now();
			if (k < 3)
				lead_obsim(&r, k < 2, k < 1);
#ifdef OB_MUJOCO_VERSION
			else
				lead_mujoco(&w, k == 4);
#endif
			took[k][i] = (now() - began) / STEPS;
		}
	printf("%-28s %8s %8s %10s\n", "us a step", "fastest", "median", "a second");
	for (int k = 0; k < kinds; k++) {
		qsort(took[k], (size_t)rounds, sizeof **took, ascending);
		printf("%-28s %8.2f %8.2f %10.0f\n", names[k], took[k][0], took[k][rounds / 2],
		       1e6 / took[k][rounds / 2]);
	}
	ob_universe_detach(r.universe);
	ob_controller_close(r.controller);
	return 0;
}
