#include "voxshell/bullet/checked_motion.h"

#include <algorithm>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "compound_algorithm.h"
#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

/// Makes a body's bounds hold its motion within the step, too.
void extend_bounds(btRigidBody& body, btScalar time_step, btBroadphaseInterface& broadphase,
                   btDispatcher& dispatcher) {
  btTransform there;
  body.predictIntegratedTransform(time_step, there);
  btVector3 least;
  btVector3 most;
  body.getCollisionShape()->getAabb(there, least, most);
  btBroadphaseProxy* const proxy = body.getBroadphaseHandle();
  least.setMin(proxy->m_aabbMin);
  most.setMax(proxy->m_aabbMax);
  broadphase.setAabb(proxy, least, most, &dispatcher);
}

int count_points(btBroadphasePair& pair) {
  if (pair.m_algorithm == nullptr) return 0;
  btManifoldArray manifolds;
  pair.m_algorithm->getAllContactManifolds(manifolds);
  int count = 0;
  for (int i = 0; i < manifolds.size(); ++i) count += manifolds[i]->getNumContacts();
  return count;
}

/// Searches for contacts of pairs that had none.
class SearchAgain : public btOverlapCallback {
 public:
  using Faster = CheckedMotion::Faster;

  SearchAgain(const std::vector<Faster>& faster, btCollisionDispatcher& dispatcher,
              const btDispatcherInfo& info)
      : faster_(faster), dispatcher_(dispatcher), info_(info) {}

  bool processOverlap(btBroadphasePair& pair) override {
    const auto* const a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto* const b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    const btScalar displacement = std::max(displacement_of(a), displacement_of(b));
    const bool rebounds = btManifoldResult::calculateCombinedRestitution(a, b) > 0;
    if (!(displacement > (rebounds ? static_cast<btScalar>(kCheckedReboundOfSize) : 0)))
      return false;
    if (!has_model(*a->getCollisionShape()) && !has_model(*b->getCollisionShape())) return false;
    if (count_points(pair) > 0) return false;
    dispatcher_.getNearCallback()(pair, dispatcher_, info_);
    has_found_ = has_found_ || count_points(pair) > 0;
    return false;  // the pair stays
  }

  bool has_found() const { return has_found_; }

 private:
  /// Of its size; 0 where it is not faster than expected.
  btScalar displacement_of(const btCollisionObject* object) const {
    const auto found =
        std::ranges::lower_bound(faster_, btRigidBody::upcast(object), {}, &Faster::body);
    return found != faster_.end() && found->body == object ? found->displacement : btScalar(0);
  }

  const std::vector<Faster>& faster_;
  btCollisionDispatcher& dispatcher_;
  const btDispatcherInfo& info_;
  bool has_found_ = false;
};

/// Undoes a factor by axis; where that is 0, so is what it made.
btVector3 divide(const btVector3& v, const btVector3& factor) {
  const auto by = [](btScalar x, btScalar f) { return f != 0 ? x / f : btScalar(0); };
  return {by(v.x(), factor.x()), by(v.y(), factor.y()), by(v.z(), factor.z())};
}

}  // namespace

CheckedMotion::State CheckedMotion::State::of(const btRigidBody& body) {
  return {body.getWorldTransform(), body.getLinearVelocity(), body.getAngularVelocity()};
}

void CheckedMotion::State::put_on(btRigidBody& body) const {
  body.setWorldTransform(world_from_body);
  body.setLinearVelocity(linear_velocity);
  body.setAngularVelocity(angular_velocity);
}

void CheckedMotion::begin(const btAlignedObjectArray<btRigidBody*>& bodies) {
  all_.clear();
  for (int i = 0; i < bodies.size(); ++i) {
    btRigidBody& body = *bodies[i];
    if (!(body.getInvMass() > 0) || !body.isActive()) continue;
    const State before = State::of(body);
    all_.push_back({&body, before, before, body.getTotalForce(), body.getTotalTorque()});
  }
}

/// How far a place of the body moves, if that is farther than the search for contacts expected, by
/// half of what it expected and a fraction of the body's size; else 0.
btScalar CheckedMotion::displacement_if_faster(const Checked& checked, btScalar time_step) {
  const btRigidBody& body = *checked.body;
  const btScalar size = body.getCollisionShape()->getAngularMotionDisc();
  const auto displacement = [&](const btVector3& linear, const btVector3& angular) {
    return time_step * (linear.length() + size * angular.length());
  };
  const State& before = checked.before;
  const State& solved = checked.solved;
  const btScalar least = static_cast<btScalar>(kCheckedOfSize) * size;
  const btScalar farthest = displacement(solved.linear_velocity, solved.angular_velocity);
  if (farthest <= least) return 0;
  const btVector3 of_forces = (body.getInvMass() * time_step) * checked.force;
  const btVector3 change = solved.linear_velocity - before.linear_velocity;
  const btVector3 turning = solved.angular_velocity - before.angular_velocity;
  const btScalar unexpected =
      std::min(displacement(change, turning), displacement(change - of_forces, turning));
  const btScalar expected = displacement(before.linear_velocity, before.angular_velocity);
  return unexpected > static_cast<btScalar>(kCheckedOfExpected) * expected + least ? farthest
                                                                                   : btScalar(0);
}

bool CheckedMotion::find_contacts(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                                  const btDispatcherInfo& info) {
  faster_.clear();
  for (Checked& checked : all_) {
    checked.solved = State::of(*checked.body);
    const btScalar farthest = displacement_if_faster(checked, info.m_timeStep);
    if (!(farthest > 0)) continue;
    faster_.push_back(
        {checked.body, farthest / checked.body->getCollisionShape()->getAngularMotionDisc()});
  }
  if (faster_.empty()) return false;
  std::ranges::sort(faster_, {}, &Faster::body);
  for (const Checked& checked : all_) {
    // Their velocity has what forces add.
    State{checked.before.world_from_body, checked.solved.linear_velocity,
          checked.solved.angular_velocity}
        .put_on(*checked.body);
    checked.body->clearForces();
  }
  for (const Faster& faster : faster_) {
    extend_bounds(*faster.body, info.m_timeStep, broadphase, dispatcher);
  }
  broadphase.calculateOverlappingPairs(&dispatcher);
  SearchAgain search(faster_, static_cast<btCollisionDispatcher&>(dispatcher), info);
  broadphase.getOverlappingPairCache()->processAllOverlappingPairs(&search, &dispatcher, info);
  for (const Checked& checked : all_) {
    (search.has_found() ? checked.before : checked.solved).put_on(*checked.body);
    checked.body->applyCentralForce(divide(checked.force, checked.body->getLinearFactor()));
    checked.body->applyTorque(divide(checked.torque, checked.body->getAngularFactor()));
  }
  return search.has_found();
}

}  // namespace voxshell::bullet
