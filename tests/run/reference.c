// Masses and motions of a model in MuJoCo itself: reference MODEL SECONDS [STEP]. The model is read as obsim import reads it.
// For each body that moves one line: mass, tensor of inertia about its centre of mass in world axes (xx yy zz xy xz yz, kg
// m^2), centre of mass at the begin and at the end (m), the rotation between the two (row by row), and the centre at the end
// of a twin whose joints begin 1e-9 away (m, rad); then its name. No contacts, no limits; Runge and Kutta's method with steps
// of .1 ms, or STEP (s). With STEP the model hangs: roots that are free are held as they begin, and there are no dry friction
// and no actuators.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "import/load.h"

static void print_all(const double *x, int n)
{
	for (int i = 0; i < n; i++)
		printf(" %.17g", x[i]);
}

static void print_inertia(const mjModel *m, const double *r, int body)
{
	static const int pair[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
	for (int k = 0; k < 6; k++) {
		double sum = 0;
		for (int c = 0; c < 3; c++)
			sum += r[3 * pair[k][0] + c] * m->body_inertia[3 * body + c] * r[3 * pair[k][1] + c];
		print_all(&sum, 1);
	}
}

static const double held = 1e15; // kg, kg m^2: armature of a root that does not move

// Bodies that move, as obsim import makes objects of them (import/scene.c).
static bool moves(const ob_drawn *d, int body)
{
	const mjModel *m = d->model;
	return body && (m->body_weldid[body] != 0 || d->floats) && ob_drawn_has_mass(m, body);
}

static void hang(mjModel *m)
{
	m->opt.disableflags |= mjDSBL_FRICTIONLOSS | mjDSBL_ACTUATION;
	for (int j = 0; j < m->njnt; j++)
		for (int k = 0; m->jnt_type[j] == mjJNT_FREE && k < 6; k++)
			m->dof_armature[m->jnt_dofadr[j] + k] = held;
}

static void simulate(const mjModel *m, mjData *d, double seconds)
{
	while (d->time < seconds - .01 * m->opt.timestep)
		mj_step(m, d);
	mj_forward(m, d);
}

// Moves all joints with one axis by x from where they begin, one way and the other by turns.
static void start_away(const mjModel *m, mjData *d, double x)
{
	for (int j = 0; j < m->njnt; j++)
		if (m->jnt_type[j] == mjJNT_HINGE || m->jnt_type[j] == mjJNT_SLIDE)
			d->qpos[m->jnt_qposadr[j]] += j % 2 ? -x : x;
}

int main(int argc, char **argv)
{
	ob_drawn drawn;
	ob_error e;
	if (argc < 3 || argc > 4 || !ob_drawn_load(argv[1], false, NULL, &drawn, &e)) {
		fprintf(stderr, "%s\n", argc < 3 || argc > 4 ? "reference MODEL SECONDS [STEP]" : e.text);
		return EXIT_FAILURE;
	}
	mjModel *m = drawn.model;
	mjData *d = drawn.data, *twin = mj_makeData(m);
	const size_t bytes = (size_t)m->nbody * 9 * sizeof(double);
	double *p = malloc(bytes), *r = malloc(bytes);
	if (!twin || !p || !r)
		return EXIT_FAILURE;
	m->opt.timestep = argc == 4 ? atof(argv[3]) : 1e-4;
	m->opt.integrator = mjINT_RK4;
	m->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
	if (argc == 4)
		hang(m);
	mj_forward(m, d);
	memcpy(p, d->xipos, bytes / 3);
	memcpy(r, d->ximat, bytes);
	start_away(m, twin, 1e-9);
	simulate(m, d, atof(argv[2]));
	simulate(m, twin, atof(argv[2]));
	for (int body = 1; body < m->nbody; body++) {
		double turn[9];
		if (!moves(&drawn, body))
			continue;
		mju_mulMatMatT(turn, d->ximat + 9 * body, r + 9 * body, 3, 3, 3);
		const char *name = mj_id2name(m, mjOBJ_BODY, body);
		print_all(&m->body_mass[body], 1);
		print_inertia(m, r + 9 * body, body);
		print_all(p + 3 * body, 3);
		print_all(d->xipos + 3 * body, 3);
		print_all(turn, 9);
		print_all(twin->xipos + 3 * body, 3);
		printf(" %s\n", name && *name ? name : "body");
	}
	free(p), free(r);
	mj_deleteData(twin), mj_deleteData(d), mj_deleteModel(m);
	return EXIT_SUCCESS;
}
