// Objects come and go at random, several in one pause, in slots that are used again, between steps in which they move,
// touch and rest: shared data keep their invariants (step/invariants.h).
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"
#include "step/invariants.h"

enum { SLOTS = 40, PAUSES = 60, LIVES = 40 };

typedef struct life {
	little_universe l;
	uint64_t seed;
	uint32_t generation[SLOTS];
} life;

static bool is_present(const life *x, uint32_t id)
{
	ob_passport p;
	return ob_universe_get_passport(x->l.u, id, &p);
}

static uint32_t any(life *x, uint32_t below)
{
	return (uint32_t)(below * uniform(&x->seed));
}

// Mostly boxes and spheres that fall; now and then a static box, a kinematic one, or a plane far below.
static void create(life *x, uint32_t id)
{
	const uint32_t kind = any(x, 12);
	const double r = within(&x->seed, .1, .5);
	ob_passport p = { .id = id, .generation = ++x->generation[id], .flags = OB_OBJECT_PRESENT, .friction = .5 };
	ob_state s = { .pose = { random_vector(&x->seed, 1.5), ob_quat_identity() } };
	s.pose.p.z += 2;
	p.shape = kind == 0 ? OB_SHAPE_PLANE : kind < 6 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE;
	p.size = kind == 0 ? ob_v3(0, 0, 0) : kind < 6 ? ob_v3(r, r, r) : ob_v3(r, 0, 0);
	p.flags |= kind < 2 ? OB_OBJECT_STATIC : kind == 2 ? OB_OBJECT_KINEMATIC : 0;
	p.mass = kind > 2;
	p.inertia = ob_scale(ob_v3(1, 1, 1), .4 * p.mass * r * r);
	if (kind == 0)
		s.pose.p.z = -1 - uniform(&x->seed);
	else if (kind > 1)
		s.v = random_vector(&x->seed, 3);
	ob_write_passport(x->l.u, id, &p);
	ob_sim_place(x->l.u, id, &s);
	if (kind == 2)
		ob_sim_prescribe(x->l.u, id, NULL, 0);
}

// Creates, removes or freezes objects, the same ones more than once.
static void change(life *x, uint32_t changes)
{
	while (changes-- > 0) {
		const uint32_t id = 1 + any(x, SLOTS - 1);
		const double what = uniform(&x->seed);
		if (!is_present(x, id))
			create(x, id);
		else if (what < .7)
			ob_sim_remove(x->l.u, id);
		else if (what < .8)
			ob_sim_freeze(x->l.u, id);
		else
			ob_sim_push(x->l.u, id, random_vector(&x->seed, 20), true);
	}
}

static void test_life(uint64_t seed)
{
	little_scene *s = little_scene_new();
	life x = { .seed = seed };
	ob_error e = { "" };
	s->checked = true;
	s->capacity = SLOTS;
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	little_open(&x.l, s);
	for (int pause = 0; pause < PAUSES; pause++) {
		change(&x, any(&x, 8));
		if (!ob_invariants_hold(x.l.u, OB_INVARIANTS_AT_RESUME, &e))
			fprintf(stderr, "seed %llu, pause %d: %s\n", (unsigned long long)seed, pause, e.text);
		CHECK(!*e.text);
		if (*e.text)
			break;
		for (uint32_t id = 1; id < SLOTS; id++)
			if (ob_passport_of(x.l.u, id)->flags & OB_OBJECT_KINEMATIC)
				ob_sim_prescribe(x.l.u, id, NULL, 0);
		little_run(&x.l, any(&x, 10));
	}
	little_close(&x.l);
	free(s);
}

// Damage to each list is detected.
static void test_broken(void)
{
	little_scene *s = little_scene_new();
	ob_error e;
	little_universe l;
	s->capacity = SLOTS;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5));
	ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, 1.5));
	little_open(&l, s);
	little_run(&l, 30);
	ob_step_data *data = ob_universe_step_data(l.u);
	uint32_t *const words[] = {
		&data->first_pair[1],         &data->first_pair[0],         &data->pair[0].b,
		&data->pair_links[1].next[0], &data->count->planes,         &data->plane[0],
		&data->cell[1].next,          (uint32_t *)&data->cell[2].x, &data->cell[1].after,
		&data->schedule[1].state,     &data->solve.one[1],          &data->solve.of_64[0],
		&data->look.of_64[0],         &data->pair[0].record,        &data->count->first_idle,
		&data->count->pairs_idle,     &data->count->records_used,   &data->neighbours[1].count,
	};
	CHECK(ob_invariants_hold(l.u, OB_INVARIANTS_AFTER_STEP, &e));
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const uint32_t before = *words[i];
		int found = 0;
		for (uint32_t k = 0; k < 3; k++) {
			*words[i] = k == 0 ? before + 1 : k == 1 ? UINT32_MAX : before ^ 2;
			found += !ob_invariants_hold(l.u, OB_INVARIANTS_AFTER_STEP, &e);
		}
		if (!found)
			fprintf(stderr, "word %zu\n", i);
		CHECK(found);
		*words[i] = before;
	}
	CHECK(ob_invariants_hold(l.u, OB_INVARIANTS_AFTER_STEP, &e));
	little_close(&l);
	free(s);
}

int main(int argc, char **argv)
{
	const uint64_t lives = argc > 1 ? strtoull(argv[1], NULL, 10) : LIVES;
	test_broken();
	for (uint64_t seed = 1; seed <= lives && !check_failed; seed++)
		test_life(seed);
	return check_end();
}
