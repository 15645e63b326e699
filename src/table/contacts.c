// Contact points for outside readers, from the pair records of the last completed step. While the universe runs,
// the arranger may rewrite the list of pairs under the reader: every value is checked, and a copy that the next
// step has overtaken is taken again. While it is paused, the result is exact.
#include "table/layout.h"

enum { TRIES = 4 };

// Plain data of the step, read from outside: word by word, so that a word at least is whole.
static void copy_words(void *to, const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes / sizeof(ob_word); i++)
		((ob_word *)to)[i] = __atomic_load_n((const ob_word *)from + i, __ATOMIC_RELAXED);
}

// The version that holds after "step": it bears that stamp, or, where both objects sleep, the newest stamp before it.
static bool newest_version(const ob_universe *u, const ob_pair_key *key, uint64_t step, ob_pair_state *out)
{
	const ob_pair_record *r = u->step_data.record + key->record;
	_Alignas(ob_word) uint32_t stamp[2];
	copy_words(stamp, r->stamp, sizeof stamp);
	unsigned newest = stamp[1] == step + 1;
	if (stamp[newest] != step + 1) {
		ob_motion a, b;
		if (!ob_universe_get_motion(u, key->a, &a) || !ob_universe_get_motion(u, key->b, &b))
			return false;
		ob_passport pa, pb;
		bool rest_a = a.flags & OB_MOTION_RESTS ||
			      (ob_universe_get_passport(u, key->a, &pa) && pa.flags & OB_OBJECT_STATIC);
		bool rest_b = b.flags & OB_MOTION_RESTS ||
			      (ob_universe_get_passport(u, key->b, &pb) && pb.flags & OB_OBJECT_STATIC);
		newest = stamp[1] > stamp[0];
		if (!rest_a || !rest_b || stamp[newest] == 0 || stamp[newest] > step + 1)
			return false;
	}
	copy_words(out, &r->version[newest], sizeof *out);
	return true;
}

static bool point_makes_sense(const ob_contact_point *c)
{
	double n2 = ob_norm2(c->normal);
	return isfinite(c->position.x) && isfinite(c->position.y) && isfinite(c->position.z) && n2 > .9 && n2 < 1.1 &&
	       isfinite(c->impulse);
}

static size_t collect(const ob_universe *u, uint64_t step, ob_contact_point *out, size_t max)
{
	const ob_step_data *x = &u->step_data;
	uint32_t pairs = __atomic_load_n(&x->count->pairs, __ATOMIC_RELAXED);
	size_t n = 0;
	for (uint32_t i = 0; i < pairs && i < x->pairs_max; i++) {
		ob_pair_key key;
		ob_pair_state state;
		ob_motion a;
		copy_words(&key, x->pair + i, sizeof key);
		if (!key.active || key.a >= key.b || key.b >= x->objects_max || key.record >= x->pairs_max ||
		    !newest_version(u, &key, step, &state) || !ob_universe_get_motion(u, key.a, &a))
			continue;
		for (uint32_t k = 0; k < state.points && k < OB_PAIR_POINTS; k++) {
			ob_vec3 arm = ob_v3(state.arm_a[k][0], state.arm_a[k][1], state.arm_a[k][2]);
			ob_contact_point c = { key.a, key.b, ob_add(a.p, arm), state.normal, state.impulse[k] };
			if (!point_makes_sense(&c))
				continue;
			if (n < max)
				out[n] = c;
			n++;
		}
	}
	return n;
}

size_t ob_universe_get_contacts(const ob_universe *u, ob_contact_point *out, size_t max)
{
	size_t n = 0;
	for (int i = 0; i < TRIES; i++) {
		uint64_t step = ob_step_count(u);
		n = collect(u, step, out, max);
		if (ob_step_count(u) == step)
			break;
	}
	return n;
}
