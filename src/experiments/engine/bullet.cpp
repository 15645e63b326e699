// Bullet with the setup of its users. btDbvtBroadphase and btSequentialImpulseConstraintSolver at their defaults (warm
// start, friction along the direction of slip), with remedies for known weaknesses:
// - contact points of convex shapes and of planes by perturbation, as in SimBenchmark (Kang and Hwangbo 2018): else a
//   box on a plane gets one new point a step, and stacks fall;
// - continuous collision as in Bullet's own CcdPhysicsDemo: a body that moves by its inner radius in a step is followed
//   by a sphere of .8 of that;
// - the implicit gyroscopic term in body coordinates, Bullet's best and its default;
// - shapes at Bullet's own margins (.04 m, or a tenth of the thinnest side if that is less), which lie within the
//   given size;
// - with restitution, the advice of Bullet's author (Coumans, bullet3 issue 3094): contacts act on touch, not
//   before, and no penetration is turned into velocity. Otherwise a ball with e = 1 loses all of its energy at 240 Hz,
//   or doubles it. If all bodies are elastic, penetration is left alone, as in SimBenchmark.
#include <math.h> // C++'s own must not come in with C linkage
#include <memory>
#include <new>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vector>

#include <btBulletDynamicsCommon.h>

extern "C" {
#include "engine/world.h"
#include "engine/engines.h"
}

// Members are declared in the order of creation, and destroyed in reverse; bodies are deleted by hand before their
// world.
struct ob_engine {
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher;
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	btDiscreteDynamicsWorld world;
	std::vector<std::unique_ptr<btCollisionShape>> shape;
	std::vector<std::unique_ptr<btRigidBody>> body;
	std::vector<btVector3> force; // N; acts in every step
	std::vector<std::unique_ptr<btTypedConstraint>> joint;
	ob_drive drive = {};
	uint64_t steps = 0; // substeps, so far
	double substep; // s
	uint32_t substeps;

	ob_engine() : dispatcher(&configuration), world(&dispatcher, &broadphase, &solver, &configuration) {}
	~ob_engine()
	{
		for (auto &j : joint)
			world.removeConstraint(j.get());
		for (auto &b : body)
			world.removeRigidBody(b.get());
		ob_drive_finish(&drive);
	}
};

static btVector3 vector(ob_vec3 v)
{
	return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z));
}

static ob_vec3 vector(const btVector3 &v)
{
	return ob_v3(v.x(), v.y(), v.z());
}

static btTransform transform(const ob_pose &p)
{
	const ob_quat &q = p.q;
	return btTransform(btQuaternion(btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)), vector(p.p));
}

// One rule per process, as Bullet requires.
static btScalar pair_friction(const btCollisionObject *a, const btCollisionObject *b)
{
	return btSqrt(a->getFriction() * b->getFriction());
}

static btScalar pair_restitution(const btCollisionObject *a, const btCollisionObject *b)
{
	return btMax(a->getRestitution(), b->getRestitution());
}

static std::unique_ptr<btCollisionShape> make_hull(const ob_hull *h)
{
	auto shape = std::make_unique<btConvexHullShape>();
	for (uint32_t k = 0; k < h->corners; k++)
		shape->addPoint(vector(h->corner[k]), false);
	shape->recalcLocalAabb();
	return shape;
}

static std::unique_ptr<btCollisionShape> make_shape(const ob_world *w, const ob_passport *p)
{
	btScalar x = btScalar(p->size.x), y = btScalar(p->size.y);
	switch (p->shape) {
	case OB_SHAPE_SPHERE:
		return std::make_unique<btSphereShape>(x);
	case OB_SHAPE_BOX:
		return std::make_unique<btBoxShape>(vector(p->size));
	case OB_SHAPE_PLANE:
		return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
	case OB_SHAPE_CAPSULE:
		return std::make_unique<btCapsuleShapeZ>(x, 2 * y);
	case OB_SHAPE_CYLINDER:
		return std::make_unique<btCylinderShapeZ>(btVector3(x, x, y));
	case OB_SHAPE_HULL:
		return make_hull(&w->hull[p->hull]);
	default:
		return std::make_unique<btEmptyShape>();
	}
}

static void add(ob_engine *b, const ob_world *w, const ob_passport *p, const ob_state *s, bool sleeping)
{
	b->shape.push_back(make_shape(w, p));
	bool moves = !(p->flags & OB_OBJECT_STATIC) && p->mass > 0;
	btRigidBody::btRigidBodyConstructionInfo info(moves ? btScalar(p->mass) : btScalar(0), nullptr,
						      b->shape.back().get(), vector(p->inertia));
	info.m_startWorldTransform = transform(s->pose);
	info.m_friction = btScalar(p->friction);
	info.m_restitution = btScalar(p->restitution);
	b->body.push_back(std::make_unique<btRigidBody>(info));
	btRigidBody *body = b->body.back().get();
	body->setLinearVelocity(vector(s->v));
	body->setAngularVelocity(vector(s->w));
	body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
	if (moves && p->shape != OB_SHAPE_NONE) {
		btScalar inner = btScalar(.5 * ob_shape_thickness(ob_shape(p->shape), p->size));
		body->setCcdMotionThreshold(inner);
		body->setCcdSweptSphereRadius(btScalar(.8) * inner);
	}
	if (p->restitution > 0)
		body->setContactProcessingThreshold(0);
	const bool driven = p->flags & OB_OBJECT_KINEMATIC;
	if (driven)
		body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
	if (driven || (moves && !sleeping))
		body->setActivationState(DISABLE_DEACTIVATION);
	b->force.push_back(vector(p->force));
	b->world.addRigidBody(body);
}

// ---- joints: constraints of six degrees of freedom, each of which is locked, limited or free

// An axis of Bullet's: 0..2 shifts, 3..5 turns. Its shifts are those of the second object, its turns and all rates of the first.
static void set_axis(btGeneric6DofSpring2Constraint *c, int i, const ob_joint_axis &a)
{
	const double far = 1e6, low = fmax(a.low, -far), high = fmin(a.high, far);
	const btScalar sign = i < 3 ? btScalar(-1) : btScalar(1);
	if (i < 3 && (isfinite(a.low) || isfinite(a.high)))
		c->setLimit(i, btScalar(-high), btScalar(-low));
	if (i >= 3 && (isfinite(a.low) || isfinite(a.high))) { // setLimit() takes turns away
		c->getRotationalLimitMotor(i - 3)->m_loLimit = btScalar(low);
		c->getRotationalLimitMotor(i - 3)->m_hiLimit = btScalar(high);
	}
	if (a.restitution > 0) { // with less than all of its error reduction a limit brakes what comes near it
		c->setBounce(i, btScalar(a.restitution));
		c->setParam(BT_CONSTRAINT_STOP_ERP, 1, i);
	}
	if (a.stiffness > 0 || a.damping > 0) {
		c->enableSpring(i, true);
		c->setStiffness(i, btScalar(a.stiffness), false);
		c->setDamping(i, btScalar(a.damping), false);
		c->setEquilibriumPoint(i, sign * btScalar(a.rest));
	}
	const bool holds = a.motor == OB_MOTOR_RATE;
	if (holds || a.friction > 0) {
		const double most = holds ? a.most : a.friction;
		c->enableMotor(i, true);
		c->setTargetVelocity(i, holds ? btScalar(a.target) : btScalar(0));
		c->setMaxMotorForce(i, isfinite(most) ? btScalar(most) : SIMD_INFINITY);
	}
}

static void join(ob_engine *p, const ob_joint_passport *j)
{
	const bool cross = j->kind == OB_JOINT_UNIVERSAL; // turns about x of the first object, y of the second
	btRigidBody *end[2];
	for (int side = 0; side < 2; side++)
		end[side] = j->object[side] == OB_JOINT_WORLD ? &btTypedConstraint::getFixedBody()
							      : p->body[j->object[side]].get();
	if (j->kind == OB_JOINT_APART) {
		end[0]->setIgnoreCollisionCheck(end[1], true);
		return;
	}
	auto c = std::make_unique<btGeneric6DofSpring2Constraint>(*end[0], *end[1], transform(j->frame[0]),
								  transform(j->frame[1]), cross ? RO_YZX : RO_XYZ);
	for (int i = 0; i < 6; i++) {
		const bool ball = j->kind == OB_JOINT_BALL && i >= 3, hinge = j->kind == OB_JOINT_HINGE && i == 5,
			   slide = j->kind == OB_JOINT_SLIDER && i == 2, first = cross && i == 3,
			   second = cross && i == 4;
		const bool free = ball || hinge || slide || first || second;
		c->setLimit(i, free ? 1 : 0, free ? -1 : 0);
		if (free && j->flags & OB_JOINT_DRIVEN)
			set_axis(c.get(), i, second ? j->second : j->axis);
	}
	p->world.addConstraint(c.get(), !(j->flags & OB_JOINT_COLLIDES));
	p->joint.push_back(std::move(c));
}

static void allow_for_bounces(btContactSolverInfo *info, const ob_world *w)
{
	bool any = false, all = true;
	for (uint32_t i = 0; i < w->objects; i++) {
		any |= w->passport[i].restitution > 0;
		all &= w->passport[i].restitution >= 1 || w->passport[i].flags & OB_OBJECT_STATIC;
	}
	if (any)
		info->m_splitImpulsePenetrationThreshold = 0;
	if (any && all)
		info->m_erp2 = 0;
}

static void place_driven(ob_engine *p)
{
	for (uint32_t i = 0; i < p->drive.count; i++) {
		btRigidBody *b = p->body[p->drive.body[i].id].get();
		const ob_state s = ob_drive_step(&p->drive, i, double(p->steps) * p->substep, p->substep);
		b->setWorldTransform(transform(s.pose));
		b->setInterpolationWorldTransform(b->getWorldTransform());
	}
}

// Called within a step, after Bullet has derived the velocities of kinematic bodies from two transforms: in single
// precision, a turn below half a milliradian would be lost.
static void give_velocities(btDynamicsWorld *world, btScalar h)
{
	(void)h;
	const ob_engine *p = static_cast<const ob_engine *>(world->getWorldUserInfo());
	for (uint32_t i = 0; i < p->drive.count; i++) {
		btRigidBody *b = p->body[p->drive.body[i].id].get();
		const ob_state s = ob_drive_step(&p->drive, i, double(p->steps) * p->substep, p->substep);
		b->setLinearVelocity(vector(s.v));
		b->setAngularVelocity(vector(s.w));
	}
}

static void set_up(ob_engine *b, const ob_world *w, const ob_run_settings *s)
{
	gCalculateCombinedFrictionCallback = pair_friction;
	gCalculateCombinedRestitutionCallback = pair_restitution;
	b->configuration.setConvexConvexMultipointIterations();
	b->configuration.setPlaneConvexMultipointIterations(5);
	b->world.setGravity(vector(w->gravity));
	b->world.getSolverInfo().m_numIterations = int(s->iterations);
	allow_for_bounces(&b->world.getSolverInfo(), w);
	b->substeps = s->substeps;
	b->substep = s->step_length / s->substeps;
	if (!ob_drive_init(&b->drive, w))
		throw std::bad_alloc();
	b->world.setInternalTickCallback(give_velocities, b, true);
	for (uint32_t i = 0; i < w->objects; i++)
		add(b, w, &w->passport[i], &w->state[i], s->sleeping);
	for (uint32_t i = 0; i < w->joints; i++)
		join(b, &w->joint[i]);
}

static ob_engine *create(const ob_world *w, const ob_run_settings *s, uint32_t variant, ob_error *e)
{
	(void)variant;
	try {
		auto b = std::make_unique<ob_engine>();
		set_up(b.get(), w, s);
		return b.release();
	} catch (const std::bad_alloc &) {
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
		return nullptr;
	}
}

static void destroy(ob_engine *p)
{
	delete p;
}

// Without subdivision of time, Bullet makes one step.
static bool step(ob_engine *p, ob_error *e)
{
	(void)e;
	for (uint32_t k = 0; k < p->substeps; k++) {
		for (size_t i = 0; i < p->body.size(); i++)
			if (!p->force[i].isZero())
				p->body[i]->applyCentralForce(p->force[i]);
		p->world.stepSimulation(btScalar(p->substep), 0);
		p->steps++;
		place_driven(p);
	}
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	for (size_t i = 0; i < p->body.size(); i++) {
		const btRigidBody *b = p->body[i].get();
		btQuaternion q = b->getOrientation();
		state[i].pose.p = vector(b->getCenterOfMassPosition());
		state[i].pose.q = ob_quat_normalize({ q.w(), q.x(), q.y(), q.z() });
		state[i].v = vector(b->getLinearVelocity());
		state[i].w = vector(b->getAngularVelocity());
	}
}

extern "C" {
OB_PART(ob_engine_part) = { OB_PART_HEAD(ob_engine_part), .create = create, .step = step, .get = get,
			    .destroy = destroy };
}
