// The generator against its published reference, and the distributions drawn from it.
#include "check.h"
#include "scene/random.h"
#include "text.h"

static void check_reference(void)
{
	// Outputs of the authors' C code (prng.di.unimi.it) from these states
	static const uint64_t outputs[] = { 11520, 0, 1509978240, 1215971899390074240u };
	ob_random r = { { 1, 2, 3, 4 } };
	for (int i = 0; i < 4; i++)
		CHECK(ob_random_next(&r) == outputs[i]);
	ob_random_seed(&r, 0);
	CHECK(r.s[0] == 0xe220a8397b1dcdafu && r.s[1] == 0x6e789e6aa1b965f4u);
	CHECK(r.s[2] == 0x06c45d188009454fu && r.s[3] == 0xf88bb8a8724c81ecu);
}

static void check_distributions(void)
{
	enum { N = 100000 };
	ob_random r;
	double mean = 0, count[7] = { 0 }, square[4] = { 0 };
	ob_random_seed(&r, 3);
	for (int i = 0; i < N; i++) {
		double x = ob_random_real(&r);
		CHECK(x >= 0 && x < 1);
		mean += x / N;
		count[ob_random_up_to(&r, 6)]++;
		ob_quat q = ob_random_rotation(&r);
		square[0] += q.w * q.w / N;
		square[1] += q.x * q.x / N;
		square[2] += q.y * q.y / N;
		square[3] += q.z * q.z / N;
	}
	CHECK_NEAR(mean, .5, .005);
	for (int i = 0; i < 7; i++)
		CHECK_NEAR(count[i], N / 7., 600); // 5 standard deviations
	for (int i = 0; i < 4; i++)
		CHECK_NEAR(square[i], .25, .005);
	CHECK(ob_random_up_to(&r, 0) == 0);
	ob_random_up_to(&r, UINT64_MAX);
}

static void check_calls(void)
{
	ob_scene *s = load_good("for i = 1, 1000 do\n"
				"  local x = random(2, 3) assert(x >= 2 and x < 3)\n"
				"  local k = math.random(6) assert(k >= 1 and k <= 6 and math.type(k) == 'integer')\n"
				"  k = math.random(-3, 3) assert(k >= -3 and k <= 3)\n"
				"  math.random(math.mininteger, math.maxinteger)\n"
				"  assert(math.random() < 1)\n"
				"  local q = random_rotation()\n"
				"  assert(math.abs(q[1] ^ 2 + q[2] ^ 2 + q[3] ^ 2 + q[4] ^ 2 - 1) < 1e-14)\n"
				"end sphere { radius = 1 }");
	CHECK(s);
	ob_scene_free(s);
}

// The seed in scene { } and the one of the command line, which comes first.
static void check_seeds(void)
{
	static const char text[] = "scene { seed = 4 } sphere { radius = 1 + random() }";
	ob_scene_options o = { .has_seed = true, .seed = 4 };
	ob_scene *a = load_good(text), *b = load_good("sphere { radius = 1 + random() }");
	ob_scene *c = load_bytes(text, sizeof text - 1, &o, NULL);
	o.seed = 5;
	ob_scene *d = load_bytes(text, sizeof text - 1, &o, NULL);
	CHECK(a && b && c && d);
	if (a && b && c && d) {
		CHECK(a->object[0].passport.size.x == c->object[0].passport.size.x);
		CHECK(a->object[0].passport.size.x != b->object[0].passport.size.x);
		CHECK(a->object[0].passport.size.x != d->object[0].passport.size.x);
		CHECK(d->seed == 5 && a->seed == 4);
	}
	ob_scene_free(a);
	ob_scene_free(b);
	ob_scene_free(c);
	ob_scene_free(d);
}

int main(void)
{
	check_reference();
	check_distributions();
	check_calls();
	check_seeds();
	return check_end();
}
