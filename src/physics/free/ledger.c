#include "free/ledger.h"

#include <math.h>
#include <string.h>

static const double hold_steps =
	3; // steps of its own for which a load goes on where no bound of the lag holds its sender

enum { IMPULSE, TWIST = 3, SHIFT = 6, TURN = 9 }; // parts of ob_account.sum

static ob_vec3 part(const double *of, int first)
{
	return ob_v3(of[first], of[first + 1], of[first + 2]);
}

static void add(double *to, int first, ob_vec3 v)
{
	to[first] += v.x, to[first + 1] += v.y, to[first + 2] += v.z;
}

// Angular momentum, N m s, of a body about its centre; and the rate, rad/s, that belongs to one.
static ob_vec3 spin_of(const ob_passport *p, ob_quat q, ob_vec3 w)
{
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 l = ob_rotate_back(&r, w);
	return ob_rotate(&r, ob_v3(l.x * p->inertia.x, l.y * p->inertia.y, l.z * p->inertia.z));
}

ob_vec3 ob_ledger_rate(const ob_passport *p, ob_quat q, ob_vec3 spin)
{
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 l = ob_rotate_back(&r, spin);
	return ob_rotate(&r, ob_v3(l.x / p->inertia.x, l.y / p->inertia.y, l.z / p->inertia.z));
}

static ob_quat turned(ob_quat q, ob_vec3 turn)
{
	return ob_quat_normalize(ob_quat_mul((ob_quat){ 1, turn.x / 2, turn.y / 2, turn.z / 2 }, q));
}

// The part that two loads have in common: the smaller one, if both point the same way.
static ob_vec3 common(ob_vec3 a, ob_vec3 b)
{
	if (!(ob_dot(a, b) > 0))
		return ob_v3(0, 0, 0);
	return ob_norm2(a) < ob_norm2(b) ? a : b;
}

// The part of a load that is to last: the one in common with what has lasted, or with what holds the body against all
// else that acts on it, whichever is larger. The latter is known in the first step of a contact.
static ob_vec3 lasting_part(ob_vec3 load, ob_vec3 lasted, ob_vec3 holding)
{
	const ob_vec3 a = common(load, lasted), b = common(load, holding);
	return ob_norm2(a) < ob_norm2(b) ? b : a;
}

// Takes a step of h (s) into the load that has lasted: its mean over twice the delay, there and back, or the step's load
// alone.
static ob_vec3 lasting(const ob_free_scratch *x, double h, ob_vec3 before, ob_vec3 load)
{
	return ob_madd(before, ob_min(1, h / ob_max(h, 2 * x->free->delay)), ob_sub(load, before));
}

// Work, J, of an impulse and a twist on a body that goes from one state to another.
static double work_of(ob_vec3 impulse, ob_vec3 twist, const ob_state *begin, ob_vec3 v, ob_vec3 w)
{
	return .5 * (ob_dot(impulse, ob_add(begin->v, v)) + ob_dot(twist, ob_add(begin->w, w)));
}

// ---- accounts

static ob_account *find(ob_free_sim *s, uint32_t partner)
{
	for (uint32_t i = 0; i < s->ledger.head.accounts; i++)
		if (s->ledger.account[i].partner == partner)
			return &s->ledger.account[i];
	return NULL;
}

static ob_account *open(ob_free_sim *s, const ob_free_neighbour *n, uint32_t epoch)
{
	if (s->ledger.head.accounts == OB_LEDGER_ACCOUNTS)
		return NULL;
	ob_account *a = &s->ledger.account[s->ledger.head.accounts++];
	*a = (ob_account){ .partner = n->id, .generation = n->generation, .epoch = epoch };
	return a;
}

static void drop(ob_free_sim *s, ob_account *a)
{
	*a = s->ledger.account[--s->ledger.head.accounts];
}

void ob_ledger_begin(ob_free_sim *s)
{
	memset(s->mailed, 0, sizeof s->mailed);
	s->passed_on = ob_v3(0, 0, 0);
	for (uint32_t i = s->ledger.head.accounts; i-- > 0;) { // partners that are gone
		bool there = false;
		for (uint32_t k = 0; k < s->neighbours; k++)
			there |= s->neighbour[k].id == s->ledger.account[i].partner &&
				 s->neighbour[k].generation == s->ledger.account[i].generation;
		if (!there)
			drop(s, &s->ledger.account[i]);
	}
}

// Time, s, up to which publications are seen: all of them, ahead or behind, unless they are delayed. Loads settle sooner.
static double newest_seen(const ob_free_sim *s, const ob_free_scratch *x)
{
	return x->free->delay > 0 ? s->time - x->free->delay : INFINITY;
}

// ---- the higher id

// Time, s, for which a deposit's rate goes on until the end of a step; below 0: it is newer than that.
static double extrapolated(const ob_free_scratch *x, double from, double to, double h)
{
	const double most = h * hold_steps + (isinf(x->free->max_lag) ? 0 : x->free->max_lag + x->free->delay);
	return ob_max(-most, ob_min(most, to - from));
}

bool ob_ledger_receive(ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n, double h, ob_motion *m)
{
	ob_account *own = find(s, n->id), in;
	ob_ledger_head head;
	bool found;
	if (!ob_free_schedule_read_account(x->schedule, x->u, n->id, newest_seen(s, x), s->id, m, &in, &head, &found))
		return false;
	if (!found || in.generation != s->generation) {
		if (own && own->closed)
			drop(s, own);
		else if (own)
			memset(own->rate, 0, sizeof own->rate);
		return true;
	}
	if (own && own->epoch != in.epoch) {
		drop(s, own);
		own = NULL;
	}
	if (!own && !(own = open(s, n, in.epoch)))
		return true;
	const double on = extrapolated(x, m->t0, s->time + h, h);
	for (int i = 0; i < 12; i++) {
		const double due = in.sum[i] + (i < SHIFT && !in.closed ? in.rate[i] * on : 0);
		s->mailed[i] += due - own->sum[i];
		own->sum[i] = due;
	}
	memcpy(own->rate, in.rate, sizeof own->rate);
	own->closed = in.closed;
	s->step = ob_min(s->step, head.step);
	return true;
}

void ob_ledger_shift(const ob_free_sim *s, ob_state *own)
{
	own->pose.p = ob_add(own->pose.p, part(s->mailed, SHIFT));
	own->pose.q = turned(own->pose.q, part(s->mailed, TURN));
}

// ---- the lower id

bool ob_ledger_look(ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n, ob_free_seen *seen)
{
	const ob_account *own = find(s, n->id);
	ob_ledger_head head;
	seen->version = ob_free_schedule_read_account(x->schedule, x->u, n->id, newest_seen(s, x), s->id, &seen->motion,
						      &seen->account, &head, &seen->known);
	if (!seen->version)
		return false;
	if (!seen->known || !own || seen->account.epoch != own->epoch || seen->account.generation != s->generation) {
		seen->account = (ob_account){ .partner = s->id };
		seen->known = false;
	}
	const ob_passport *p = &n->passport;
	const ob_account *theirs = &seen->account;
	const double since = s->time - seen->motion.t0;
	// several that correct the same body at once, each as if alone, would correct it too far
	const uint32_t others = head.solvers - (seen->known && !theirs->closed);
	seen->share = 1. / (1 + (others < OB_LEDGER_ACCOUNTS ? others : 0));
	seen->step = head.step;
	seen->torque = ob_madd(ob_scale(part(theirs->rate, TWIST), -1), seen->share, part(head.torque, 0));
	seen->now = ob_motion_at(&seen->motion, p->inertia, s->time);
	seen->mails = own != NULL;
	if (!own)
		return true;
	double way[12];
	for (int i = 0; i < 12; i++)
		way[i] = own->sum[i] - theirs->sum[i] - (i < SHIFT ? theirs->rate[i] * since : 0);
	seen->now.v = ob_madd(seen->now.v, 1 / p->mass, part(way, IMPULSE));
	seen->now.w = ob_add(seen->now.w, ob_ledger_rate(p, seen->now.pose.q, part(way, TWIST)));
	seen->now.pose.p = ob_add(seen->now.pose.p, part(way, SHIFT));
	seen->now.pose.q = turned(seen->now.pose.q, part(way, TURN));
	return true;
}

// True if the partner has consumed a closed account.
static bool is_settled(const ob_account *own, const ob_free_seen *seen)
{
	return own->closed && seen->known && seen->account.closed &&
	       memcmp(own->sum, seen->account.sum, sizeof own->sum) == 0;
}

// Turn, rad, from one attitude to another near it.
static ob_vec3 turn_between(ob_quat from, ob_quat to)
{
	const ob_quat d = ob_quat_mul(to, ob_quat_conjugate(from));
	return ob_scale(ob_v3(d.x, d.y, d.z), d.w < 0 ? -2 : 2);
}

bool ob_ledger_deposit(ob_free_sim *s, const ob_free_scratch *x, ob_free_neighbour *n, const ob_free_seen *seen,
		       const ob_motion *end, double h)
{
	ob_account *own = find(s, n->id);
	const bool touches = end && !(end->flags & OB_MOTION_FREE); // even if they have parted within the step
	if (!touches) {
		n->load = n->twist = ob_v3(0, 0, 0);
		if (!own)
			return true;
		memset(own->rate, 0, sizeof own->rate);
		own->closed = 1;
		if (is_settled(own, seen))
			drop(s, own);
		return true;
	}
	if (!own && !(own = open(s, n, (uint32_t)ob_free_version(x->u, s->id) + 1)))
		return false;
	const ob_passport *p = &n->passport;
	const ob_state *begin = &seen->now;
	const ob_vec3 outer = ob_sub(ob_scale(seen->motion.a, seen->share * p->mass),
				     part(seen->account.rate, IMPULSE)),
		      impulse = ob_madd(ob_scale(ob_sub(end->v, begin->v), seen->share * p->mass), -h, outer),
		      spun = ob_sub(spin_of(p, end->q, end->w), spin_of(p, begin->pose.q, begin->w)),
		      twist = ob_madd(ob_scale(spun, seen->share), -h, seen->torque),
		      way = ob_scale(ob_add(begin->v, end->v), h / 2), turn = ob_scale(ob_add(begin->w, end->w), h / 2);
	const ob_vec3 load = ob_scale(impulse, 1 / h), torque = ob_scale(twist, 1 / h),
		      rate = lasting_part(load, n->load, ob_scale(outer, -1)), turning = common(torque, n->twist);
	s->passed_on = ob_add(s->passed_on, load);
	add(own->sum, IMPULSE, impulse);
	add(own->sum, TWIST, twist);
	add(own->sum, SHIFT, ob_sub(ob_sub(end->p, begin->pose.p), way));
	add(own->sum, TURN, turn_between(turned(begin->pose.q, turn), end->q));
	memcpy(own->rate, (double[6]){ rate.x, rate.y, rate.z, turning.x, turning.y, turning.z }, sizeof own->rate);
	own->closed = 0;
	s->counts.work_seen += work_of(impulse, twist, begin, end->v, end->w);
	n->load = lasting(x, h, n->load, load), n->twist = lasting(x, h, n->twist, torque);
	return true;
}

void ob_ledger_end(ob_free_sim *s, const ob_free_scratch *x, const ob_state *own, double h, ob_motion *end)
{
	const ob_passport *p = &s->passport;
	const ob_vec3 outer = ob_external_acceleration(&x->run, p);
	// by the island: all but mail
	const ob_vec3 change = ob_madd(ob_scale(ob_sub(end->v, own->v), p->mass), -h * p->mass, outer),
		      load = ob_scale(ob_sub(change, part(s->mailed, IMPULSE)), 1 / h),
		      turned_by = ob_sub(spin_of(p, end->q, end->w), spin_of(p, own->pose.q, own->w)),
		      torque = ob_scale(ob_sub(turned_by, part(s->mailed, TWIST)), 1 / h),
		      fixed = ob_add(load, s->passed_on); // by fixed bodies
	ob_vec3 force = ob_v3(0, 0, 0), twist = common(torque, s->twist);
	s->ledger.head.solvers = x->near > 0 && !x->flew;
	for (uint32_t i = 0; i < s->ledger.head.accounts; i++) {
		const ob_account *a = &s->ledger.account[i];
		const bool consumed = a->partner < s->id;
		force = ob_madd(force, consumed ? 1 : -1, part(a->rate, IMPULSE));
		twist = ob_madd(twist, consumed, part(a->rate, TWIST));
		s->ledger.head.solvers += consumed && !a->closed;
	}
	force = ob_add(force, lasting_part(fixed, s->load, ob_scale(ob_madd(force, p->mass, outer), -1)));
	s->load = lasting(x, h, s->load, fixed), s->twist = lasting(x, h, s->twist, torque);
	s->counts.worked += work_of(part(s->mailed, IMPULSE), part(s->mailed, TWIST), own, end->v, end->w);
	end->a = ob_madd(outer, 1 / p->mass, force);
	memcpy(s->ledger.head.torque, (double[3]){ twist.x, twist.y, twist.z }, sizeof s->ledger.head.torque);
}
