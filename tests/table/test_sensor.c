// Samples of a sensor: rings as long as rates and delays need, whole copies beside a writer, damaged properties refused.
#include "../check.h"

#include <pthread.h>

#include "table/layout.h"

enum { WIDTH = 6, EACH = 5, STEPS = 100000, MOST = 64 };

static const double step = .01;

static const ob_sensor_passport usual = {
	.kind = OB_SENSOR_IMU, .generation = 1, .width = WIDTH, .rate = EACH / .01, .name = "imu"
};

static ob_universe *make(const ob_sensor_passport *s)
{
	ob_universe_setup setup = {
		.capacity = 1, .workers = 1, .isolation = "thread", .run = ob_run_settings_default(), .sensors = 1
	};
	ob_error e;
	setup.run.step_length = step;
	setup.sensor_values = (uint32_t)ob_sensor_room(s, step);
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u) {
		fprintf(stderr, "%s\n", e.text);
		return NULL;
	}
	ob_sensors_write(u, s, 1);
	return u;
}

// Takes the samples of a step: all numbers of sample k are k.
static void take(ob_universe *u)
{
	const ob_sensor_passport *s = &ob_universe_step_data(u)->sensor[0];
	const ob_sensor_cell *c = &ob_universe_step_data(u)->sensor_cell[0];
	double value[WIDTH];
	for (const uint64_t last = ob_sensor_due(s, step, ob_step_count(u) + 1, 0); c->taken < last;) {
		for (int i = 0; i < WIDTH; i++)
			value[i] = (double)(c->taken + 1);
		ob_sensor_publish(u, 0, value[0], value);
	}
	ob_step_complete(u, 0, 0, 0);
}

static void *take_all(void *u)
{
	for (int i = 0; i < STEPS; i++)
		take(u);
	return NULL;
}

static void read_beside_writer(void)
{
	ob_universe *u = make(&usual);
	pthread_t writer;
	uint64_t number[MOST], last = 0, torn = 0, back = 0, read = 0;
	double time[MOST], value[MOST * WIDTH];
	pthread_create(&writer, NULL, take_all, u);
	while (last < (uint64_t)STEPS * EACH) {
		const size_t n = ob_universe_get_samples(u, 0, last, number, time, value, MOST);
		for (size_t i = 0; i < n; i++) {
			back += number[i] <= last;
			last = number[i];
			torn += time[i] != (double)last;
			for (int k = 0; k < WIDTH; k++)
				torn += value[i * WIDTH + (size_t)k] != (double)last;
		}
		read += n;
	}
	pthread_join(writer, NULL);
	CHECK(torn == 0);
	CHECK(back == 0);
	CHECK(read > 0);
	ob_universe_destroy(u, true);
}

static void keep(double delay, uint32_t kept)
{
	ob_sensor_passport s = usual;
	uint64_t number[MOST];
	double time[MOST], value[MOST * WIDTH];
	s.delay = delay, s.kept = kept;
	ob_universe *u = make(&s);
	CHECK(ob_universe_get_samples(u, 0, 0, number, time, value, MOST) == 0);
	for (int i = 0; i < 100; i++)
		take(u);
	const uint64_t newest = 100 * EACH - (uint64_t)(delay * usual.rate + .5), wanted = kept > EACH ? kept : EACH;
	const size_t n = ob_universe_get_samples(u, 0, 0, number, time, value, MOST);
	CHECK(n >= wanted && n < MOST);
	for (size_t i = 0; i < n; i++)
		CHECK(number[i] == newest - n + 1 + i && value[i * WIDTH] == (double)number[i]);
	CHECK(ob_universe_get_samples(u, 0, newest - 2, number, time, value, MOST) == 2);
	CHECK(ob_universe_get_samples(u, 0, newest, number, time, value, MOST) == 0);
	CHECK(ob_universe_get_samples(u, 0, 0, number, time, value, 1) == 1 && number[0] == newest);
	CHECK(ob_universe_get_samples(u, 1, 0, number, time, value, MOST) == 0);
	ob_universe_destroy(u, true);
}

static void refuse_damage(void)
{
	ob_universe *u = make(&usual);
	ob_sensor_passport *s = &ob_universe_step_data(u)->sensor[0], out;
	const ob_sensor_passport whole = *s;
	CHECK(ob_universe_get_sensor(u, 0, &out) && out.rate == usual.rate);
#define DAMAGE(member, with) \
	s->member = with; \
	CHECK(!ob_universe_get_sensor(u, 0, &out)); \
	*s = whole
	DAMAGE(kind, OB_SENSOR_KINDS);
	DAMAGE(object, 1);
	DAMAGE(width, UINT32_MAX);
	DAMAGE(width, 0);
	DAMAGE(kept, UINT32_MAX);
	DAMAGE(kept, 0);
	DAMAGE(first, UINT64_MAX);
	DAMAGE(rate, NAN);
	DAMAGE(delay, -1);
	CHECK(ob_universe_get_sensor(u, 0, &out));
	ob_universe_destroy(u, true);
}

int main(void)
{
	read_beside_writer();
	keep(0, 0);
	keep(0, 20);
	keep(.023, 7);
	refuse_damage();
	return check_end();
}
