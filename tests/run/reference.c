// Masses and motions of a model in MuJoCo itself: reference MODEL SECONDS. For each body with a mass one line: name, mass,
// tensor of inertia about its centre of mass in world axes (xx yy zz xy xz yz, kg m^2), centre of mass at the begin and at
// the end (m), and the rotation between the two (row by row). No contacts, no limits; steps of .1 ms, Runge and Kutta's.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

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

int main(int argc, char **argv)
{
	char why[500] = "";
	mjModel *m = argc == 3 ? mj_loadXML(argv[1], NULL, why, sizeof why) : NULL;
	mjData *d = m ? mj_makeData(m) : NULL;
	if (!d) {
		fprintf(stderr, "%s\n", why);
		return EXIT_FAILURE;
	}
	m->opt.timestep = 1e-4;
	m->opt.integrator = mjINT_RK4;
	m->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
	mj_forward(m, d);
	const size_t bytes = (size_t)m->nbody * 9 * sizeof(double);
	double *p = malloc(bytes), *r = malloc(bytes);
	memcpy(p, d->xipos, bytes / 3);
	memcpy(r, d->ximat, bytes);
	while (d->time < atof(argv[2]) - 1e-6)
		mj_step(m, d);
	mj_forward(m, d);
	for (int body = 1; body < m->nbody; body++) {
		double turn[9];
		if (!(m->body_mass[body] > 0))
			continue;
		mju_mulMatMatT(turn, d->ximat + 9 * body, r + 9 * body, 3, 3, 3);
		const char *name = mj_id2name(m, mjOBJ_BODY, body);
		printf("%s", name && *name ? name : "body");
		print_all(&m->body_mass[body], 1);
		print_inertia(m, r + 9 * body, body);
		print_all(p + 3 * body, 3);
		print_all(d->xipos + 3 * body, 3);
		print_all(turn, 9);
		puts("");
	}
	free(p), free(r);
	mj_deleteData(d), mj_deleteModel(m);
	return EXIT_SUCCESS;
}
