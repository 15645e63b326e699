#include "contact/swept.h"

static ob_placed moved(const ob_placed *x, double t)
{
	ob_placed y = *x;
	double th = ob_norm(x->w) * t;
	y.p = ob_madd(x->p, t, x->v);
	if (th > 0) {
		ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_scale(x->w, t));
		ob_mat3 m = ob_quat_matrix(turn);
		for (int c = 0; c < 3; c++) {
			ob_vec3 axis = ob_rotate(&m, ob_column(&x->r, c));
			y.r.m[0][c] = axis.x, y.r.m[1][c] = axis.y, y.r.m[2][c] = axis.z;
		}
	}
	return y;
}

double ob_swept_find(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance, double margin,
		     ob_manifold_finder find, ob_manifold *out)
{
	double t = 0, apart = 0;
	// A grazing pass takes many small advances; after so many, what is this near counts as touching.
	for (int tries = 0; tries < 256 && t <= h; tries++) {
		ob_placed at = moved(a, t), bt = moved(b, t);
		find.find(find.with, &at, &bt, tolerance, out);
		if (tries == 0)
			apart = out->separation;
		if (out->points)
			break;
		t += (fmax(out->separation, tolerance) - .5 * tolerance) / speed;
	}
	if (t <= h) {
		ob_placed at = moved(a, t), bt = moved(b, t);
		find.find(find.with, &at, &bt, margin, out);
		if (out->points)
			return t;
	}
	out->points = 0;
	out->separation = apart;
	return INFINITY;
}
