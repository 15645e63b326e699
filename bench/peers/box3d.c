// Runs boxes on the ground in Box3D: bench/peers/box3d.py builds and calls it.
// Arguments: the steps, Hz, substeps, friction. Standard input: a box a line, half extents (m), position (m), attitude x y z w,
// density (kg/m^3). Prints the CPU time (s) of all steps and the deepest penetration (m) that its contacts had at a step.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "box3d/box3d.h"

enum { BODIES_MAX = 100000, CONTACTS_MAX = 256 };

static double cpu(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static float deepest_of(b3BodyId body)
{
	b3ContactData contact[CONTACTS_MAX];
	const int n = b3Body_GetContactData(body, contact, CONTACTS_MAX);
	float depth = 0;
	for (int i = 0; i < n; i++)
		for (int k = 0; k < contact[i].manifoldCount; k++) {
			const b3Manifold *m = &contact[i].manifolds[k];
			for (int j = 0; j < m->pointCount; j++)
				depth = m->points[j].separation < -depth ? -m->points[j].separation : depth;
		}
	return depth;
}

static void add_box(b3WorldId world, b3BodyType type, const float v[11], float friction, b3BodyId *out)
{
	b3BodyDef def = b3DefaultBodyDef();
	b3ShapeDef shape = b3DefaultShapeDef();
	const b3BoxHull hull = b3MakeBoxHull(v[0], v[1], v[2]);
	def.type = type;
	def.position = (b3Pos){ v[3], v[4], v[5] };
	def.rotation = (b3Quat){ { v[6], v[7], v[8] }, v[9] };
	shape.density = v[10];
	shape.baseMaterial.friction = friction;
	*out = b3CreateBody(world, &def);
	b3CreateHullShape(*out, &shape, &hull.base);
}

int main(int argc, char **argv)
{
	static b3BodyId body[BODIES_MAX + 1];
	const int steps = argc > 4 ? atoi(argv[1]) : 0, substeps = steps ? atoi(argv[3]) : 0;
	const float hz = steps ? strtof(argv[2], NULL) : 0, friction = steps ? strtof(argv[4], NULL) : 0;
	if (steps < 1 || substeps < 1 || !(hz > 0))
		return 2;
	b3WorldDef def = b3DefaultWorldDef();
	def.gravity = (b3Vec3){ 0, 0, -9.81f };
	const b3WorldId world = b3CreateWorld(&def);
	add_box(world, b3_staticBody, (const float[11]){ 1000, 1000, 10, 0, 0, -10, 0, 0, 0, 1, 1 }, friction,
		&body[BODIES_MAX]);
	int bodies = 0;
	for (float v[11]; bodies < BODIES_MAX; bodies++) {
		int read = 0;
		while (read < 11 && scanf("%f", &v[read]) == 1)
			read++;
		if (read < 11)
			break;
		add_box(world, b3_dynamicBody, v, friction, &body[bodies]);
	}
	double time = 0;
	float depth = 0;
	for (int step = 0; step < steps; step++) {
		const double begin = cpu();
		b3World_Step(world, 1 / hz, substeps);
		time += cpu() - begin;
		for (int i = 0; i < bodies; i++) {
			const float d = deepest_of(body[i]);
			depth = d > depth ? d : depth;
		}
	}
	printf("%.9g %.9g\n", time, (double)depth);
	return 0;
}
