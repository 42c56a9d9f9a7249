#include "solved_motion_search.h"

#include <algorithm>
#include <typeinfo>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "blows.h"
#include "compound_algorithm.h"
#include "contact_constants.h"
#include "model_algorithm.h"
#include "wrap_object.h"

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

/// Whether the bodies, as the solver has them move, pass a contact of theirs within the step.
bool pass_contact(btCollisionAlgorithm& algorithm, btScalar time_step) {
  btManifoldArray manifolds;
  algorithm.getAllContactManifolds(manifolds);
  for (int m = 0; m < manifolds.size(); ++m) {
    const btRigidBody& first = *btRigidBody::upcast(manifolds[m]->getBody0());
    const btRigidBody& second = *btRigidBody::upcast(manifolds[m]->getBody1());
    for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
      if (is_passed(first, second, manifolds[m]->getContactPoint(i), time_step, kCheckedOfSize))
        return true;
    }
  }
  return false;
}

}  // namespace

/// Searches for contacts of bodies that the solver made fast.
class SolvedMotionSearch::Callback : public btOverlapCallback {
 public:
  /// @param faster  By address.
  /// @param added   Where further contacts of pairs go that have some.
  Callback(std::span<btRigidBody* const> faster, btCollisionDispatcher& dispatcher,
           const btDispatcherInfo& info, std::vector<Added>& added)
      : faster_(faster), dispatcher_(dispatcher), info_(info), added_(added) {}

  bool processOverlap(btBroadphasePair& pair) override {
    auto* const a = static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    auto* const b = static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    if (!std::ranges::binary_search(faster_, a) && !std::ranges::binary_search(faster_, b))
      return false;
    if (!has_model(*a->getCollisionShape()) && !has_model(*b->getCollisionShape())) return false;
    if (count_points(pair) > 0) {
      const bool may_add = btRigidBody::upcast(a) != nullptr && btRigidBody::upcast(b) != nullptr &&
                           dispatcher_.needsResponse(a, b) && !passes_known(pair, *a, *b);
      has_found_ = (may_add && add(*pair.m_algorithm, *a, *b)) || has_found_;
      return false;
    }
    dispatcher_.getNearCallback()(pair, dispatcher_, info_);
    has_found_ = has_found_ || count_points(pair) > 0;
    return false;  // the pair stays
  }

  bool has_found() const { return has_found_; }

 private:
  /// Whether bodies have come back to a contact, where they rebound first.
  bool passes_known(btBroadphasePair& pair, const btCollisionObject& a,
                    const btCollisionObject& b) const {
    return pass_contact(*pair.m_algorithm, info_.m_timeStep) ||
           std::ranges::any_of(added_, [&](const Added& added) {
             return added.a == &a && added.b == &b &&
                    pass_contact(*added.algorithm, info_.m_timeStep);
           });
  }

  /// @param known  The algorithm of the pair.
  bool add(const btCollisionAlgorithm& known, btCollisionObject& a, btCollisionObject& b) {
    const btCollisionObjectWrapper wrap_a = wrap_object(a);
    const btCollisionObjectWrapper wrap_b = wrap_object(b);
    if (typeid(known) == typeid(ModelAlgorithm)) {
      const btScalar size = size_of(*btRigidBody::upcast(&a), *btRigidBody::upcast(&b));
      const double least = kDeepOfChecked * kCheckedOfSize * static_cast<double>(size);
      if (!static_cast<const ModelAlgorithm&>(known).may_be_deep_on_the_way(
              wrap_a, wrap_b, static_cast<double>(info_.m_timeStep), least)) {
        return false;
      }
    }
    btCollisionAlgorithm* const algorithm =
        dispatcher_.findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    if (algorithm == nullptr) return false;
    btManifoldResult result(&wrap_a, &wrap_b);
    algorithm->processCollision(&wrap_a, &wrap_b, info_, &result);
    if (pass_contact(*algorithm, info_.m_timeStep)) {
      added_.push_back({&a, &b, algorithm});
      return true;
    }
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return false;
  }

  std::span<btRigidBody* const> faster_;
  btCollisionDispatcher& dispatcher_;
  const btDispatcherInfo& info_;
  std::vector<Added>& added_;
  bool has_found_ = false;
};

SolvedMotionSearch::~SolvedMotionSearch() { drop_added(); }

bool SolvedMotionSearch::find(std::span<btRigidBody* const> faster,
                              std::span<btRigidBody* const> by_address,
                              btBroadphaseInterface& broadphase, btCollisionDispatcher& dispatcher,
                              const btDispatcherInfo& info) {
  if (faster.empty()) return false;
  for (btRigidBody* const body : faster) {
    extend_bounds(*body, info.m_timeStep, broadphase, dispatcher);
  }
  broadphase.calculateOverlappingPairs(&dispatcher);
  added_of_ = &dispatcher;
  Callback callback(by_address, dispatcher, info, added_);
  broadphase.getOverlappingPairCache()->processAllOverlappingPairs(&callback, &dispatcher, info);
  return callback.has_found();
}

void SolvedMotionSearch::drop_added() {
  for (const Added& added : added_) {
    added.algorithm->~btCollisionAlgorithm();
    added_of_->freeCollisionAlgorithm(added.algorithm);
  }
  added_.clear();
}

}  // namespace voxshell::bullet
