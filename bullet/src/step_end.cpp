#include "step_end.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "contact_constants.h"
#include "second_shell.h"
#include "turning_speed.h"
#include "wrap_object.h"

namespace voxshell::bullet {
namespace {

template <class Visit>
void visit_points(const btManifoldArray& manifolds, const Visit& visit) {
  for (int m = 0; m < manifolds.size(); ++m) {
    for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
      visit(manifolds[m]->getContactPoint(i));
    }
  }
}

/// A place where two bodies are in each other. World frame.
struct Overlap {
  btVector3 normal;  ///< outwards of the second body
  btVector3 on_a;
  btVector3 on_b;
  btScalar distance;  ///< negative
};

/// Those that a contact test reports.
class Overlaps : public btManifoldResult {
 public:
  Overlaps(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b)
      : btManifoldResult(&a, &b), a_(a.getCollisionObject()) {
    m_closestPointDistanceThreshold = 0;
  }

  void addContactPoint(const btVector3& normal_on_b, const btVector3& on_b,
                       btScalar distance) override {
    if (count_ == found_.size()) return;
    const btVector3 on_a = on_b + distance * normal_on_b;
    const bool is_swapped = m_manifoldPtr->getBody0() != a_;
    found_[count_++] = is_swapped ? Overlap{-normal_on_b, on_b, on_a, distance}
                                  : Overlap{normal_on_b, on_a, on_b, distance};
  }

  std::span<const Overlap> all() const { return std::span(found_).first(count_); }
  /// The distance of the deepest; 0 where there is none.
  btScalar deepest() const {
    btScalar distance = 0;
    for (const Overlap& overlap : all()) distance = std::min(distance, overlap.distance);
    return distance;
  }
  /// That is the deepest; there is one.
  const Overlap& deepest_place() const {
    return *std::ranges::min_element(all(), {}, &Overlap::distance);
  }

 private:
  const btCollisionObject* a_;
  std::array<Overlap, static_cast<std::size_t>(2 * MANIFOLD_CACHE_SIZE)> found_{};
  std::size_t count_ = 0;
};

/// A body at a pose.
struct Posed {
  btRigidBody& body;
  btTransform pose;

  btCollisionObjectWrapper wrap() const {
    return wrap_object(body, *body.getCollisionShape(), pose);
  }
  btVector3 velocity_at(const btVector3& place) const {
    return body.getLinearVelocity() + turning_at(place);
  }
  /// What turning about the center of mass adds to that.
  btVector3 turning_at(const btVector3& place) const {
    return body.getAngularVelocity().cross(place - pose.getOrigin());
  }
  /// The same lever from the center of mass where the step begins.
  btVector3 at_start(const btVector3& place) const {
    return body.getWorldTransform().getOrigin() + (place - pose.getOrigin());
  }
};

/// Where the step ends if the body goes on as the solver has it.
Posed end_of(btRigidBody& body, btScalar time_step) {
  Posed there{body, body.getWorldTransform()};
  if (!body.isStaticObject()) body.predictIntegratedTransform(time_step, there.pose);
  return there;
}

/// The same if the body turned for this time alone.
Posed turned_for(btScalar time, const Posed& end) {
  btTransform pose = end.body.getWorldTransform();
  if (!end.body.isStaticObject()) end.body.predictIntegratedTransform(time, pose);
  pose.setOrigin(end.pose.getOrigin());
  return {end.body, pose};
}

Overlaps find_overlaps(const Posed& a, const Posed& b, btCollisionDispatcher& dispatcher,
                       const btDispatcherInfo& info) {
  const btCollisionObjectWrapper wrap_a = a.wrap();
  const btCollisionObjectWrapper wrap_b = b.wrap();
  Overlaps overlaps(wrap_a, wrap_b);
  btCollisionAlgorithm* const algorithm =
      dispatcher.findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CLOSEST_POINT_ALGORITHMS);
  if (algorithm == nullptr) return overlaps;
  algorithm->processCollision(&wrap_a, &wrap_b, info, &overlaps);
  algorithm->~btCollisionAlgorithm();
  dispatcher.freeCollisionAlgorithm(algorithm);
  return overlaps;
}

/// How fast turning brings two bodies together or apart at a place, m/s. It is 0 where a round body
/// touches.
btScalar closing_by_turning(const Posed& a, const Posed& b, const btVector3& place,
                            const btVector3& normal) {
  return btFabs(normal.dot(a.turning_at(place) - b.turning_at(place)));
}

/// The most at contacts.
btScalar closing_by_turning(const btManifoldArray& manifolds, const Posed& a, const Posed& b) {
  btScalar most = 0;
  visit_points(manifolds, [&](const btManifoldPoint& point) {
    most = std::max(most,
                    closing_by_turning(a, b, point.getPositionWorldOnB(), point.m_normalWorldOnB));
  });
  return most;
}

/// How far places of contacts move at most, as the other body sees them.
btScalar farthest_of(const btManifoldArray& manifolds, const Posed& a, const Posed& b,
                     btScalar time_step) {
  btScalar farthest = 0;
  visit_points(manifolds, [&](const btManifoldPoint& point) {
    const btVector3& at = point.getPositionWorldOnB();
    farthest = std::max(farthest, (a.velocity_at(at) - b.velocity_at(at)).length() * time_step);
  });
  return farthest;
}

/// Half of a body's shortest side.
btScalar thickness_of(const btRigidBody& body) {
  btVector3 low;
  btVector3 high;
  body.getCollisionShape()->getAabb(btTransform::getIdentity(), low, high);
  const btVector3 sides = high - low;
  return btScalar(0.5) * sides[sides.minAxis()];
}

/// A contact with what another one of the pair says of its bodies' materials.
btManifoldPoint make_point(const btManifoldPoint& like, const Posed& first, const Posed& second,
                           const Overlap& overlap, btScalar distance) {
  btManifoldPoint point = like;
  point.m_positionWorldOnA = first.at_start(overlap.on_a);
  point.m_positionWorldOnB = second.at_start(overlap.on_b);
  point.m_localPointA = first.body.getWorldTransform().invXform(point.m_positionWorldOnA);
  point.m_localPointB = second.body.getWorldTransform().invXform(point.m_positionWorldOnB);
  point.m_normalWorldOnB = overlap.normal;
  point.setDistance(distance);
  point.m_index0 = point.m_index1 = static_cast<int>(kEndContact);
  point.m_userPersistentData = nullptr;
  point.m_appliedImpulse = point.m_appliedImpulseLateral1 = point.m_appliedImpulseLateral2 = 0;
  point.m_combinedRestitution = 0;
  point.m_lifeTime = 0;
  point.m_contactPointFlags &= ~BT_CONTACT_FLAG_FRICTION_ANCHOR;
  set_turning_speed(point, 0);
  btPlaneSpace1(point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2);
  return point;
}

/// A free place of the manifolds, or that of the farthest contact that carries nothing; or null.
btManifoldPoint* take_place(btManifoldArray& manifolds) {
  for (int m = 0; m < manifolds.size(); ++m) {
    const int count = manifolds[m]->getNumContacts();
    if (count == 0 || count == MANIFOLD_CACHE_SIZE) continue;
    manifolds[m]->setNumContacts(count + 1);
    return &manifolds[m]->getContactPoint(count);
  }
  btManifoldPoint* idle = nullptr;
  visit_points(manifolds, [&](btManifoldPoint& point) {
    const bool is_new = point.m_index0 == static_cast<int>(kEndContact);
    if (is_new || point.m_appliedImpulse > 0) return;
    if (point.m_userPersistentData != nullptr) return;  // the user's
    if (idle == nullptr || point.getDistance() > idle->getDistance()) idle = &point;
  });
  return idle;
}

}  // namespace

bool StepEnd::add_contacts(btCollisionAlgorithm& algorithm, btRigidBody& a, btRigidBody& b,
                           btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  const btScalar time_step = info.m_timeStep;
  const btScalar angle = (a.getAngularVelocity() - b.getAngularVelocity()).length() * time_step;
  if (!(angle > 0) || angle > static_cast<btScalar>(kMostAngleOfEnd)) return false;
  // A blow would rebound.
  if (gCalculateCombinedRestitutionCallback(&a, &b) > 0) return false;
  manifolds_.resize(0);
  algorithm.getAllContactManifolds(manifolds_);
  btScalar allowed = 0;  // what is in the other body already is left to the next step
  const btManifoldPoint* known = nullptr;
  visit_points(manifolds_, [&](const btManifoldPoint& point) {
    known = &point;
    allowed = std::min(allowed, point.getDistance());
  });
  if (known == nullptr) return false;
  const btManifoldPoint like = *known;
  const btScalar size_of_a = a.getCollisionShape()->getAngularMotionDisc();
  const btScalar size_of_b = b.getCollisionShape()->getAngularMotionDisc();
  const btScalar size = std::min(size_of_a, size_of_b);
  const btRigidBody& smaller = size_of_a < size_of_b ? a : b;
  const btScalar least = static_cast<btScalar>(kEndOfSize) * size;
  const Posed start_a{a, a.getWorldTransform()};
  const Posed start_b{b, b.getWorldTransform()};
  const btScalar farthest = farthest_of(manifolds_, start_a, start_b, time_step) + angle * size;
  // Half the angle times the displacement is what a straight line misses of an arc.
  if (btScalar(0.5) * angle * farthest < least) return false;
  const Posed end_a = end_of(a, time_step);
  const Posed end_b = end_of(b, time_step);
  const Overlaps overlaps = find_overlaps(end_a, end_b, dispatcher, info);
  const btScalar depth = allowed - overlaps.deepest();
  if (!(depth > least)) return false;
  // Round bodies do not come to face others with other places by turning.
  const Overlap& deepest = overlaps.deepest_place();
  const btScalar by_turning =
      std::max(closing_by_turning(manifolds_, start_a, start_b),
               closing_by_turning(end_a, end_b, deepest.on_b, deepest.normal)) *
      time_step;
  if (by_turning < static_cast<btScalar>(kLeastByTurning) * depth) return false;
  // Facets do, a little. Others may be as deep by chance, with another place, but not on the way.
  const btScalar same = btClamped(static_cast<btScalar>(kSameOfThickness) * thickness_of(smaller),
                                  static_cast<btScalar>(kLeastSameOfDepth) * depth,
                                  static_cast<btScalar>(kMostSameOfDepth) * depth);
  const auto is_as_deep_turned_for = [&](btScalar time) {
    const Overlaps there =
        find_overlaps(turned_for(time, end_a), turned_for(time, end_b), dispatcher, info);
    return btFabs(deepest.distance - there.deepest()) < same;
  };
  if (is_as_deep_turned_for(0) && is_as_deep_turned_for(btScalar(0.5) * time_step)) return false;
  const bool is_swapped = manifolds_[0]->getBody0() != &a;
  bool has_added = false;
  for (const Overlap& overlap : overlaps.all()) {
    const btScalar closing =
        overlap.normal.dot(end_b.velocity_at(overlap.on_b) - end_a.velocity_at(overlap.on_a)) *
        time_step;
    if (!(overlap.distance < allowed - least) || !(closing > 0)) continue;
    btManifoldPoint* const place = take_place(manifolds_);
    if (place == nullptr) break;
    // With that gap now, moving as the solver has it, the bodies end the step so deep.
    const btScalar gap = overlap.distance - allowed + closing;
    *place = is_swapped ? make_point(like, end_b, end_a,
                                     {-overlap.normal, overlap.on_b, overlap.on_a, 0}, gap)
                        : make_point(like, end_a, end_b, overlap, gap);
    has_added = true;
  }
  return has_added;
}

}  // namespace voxshell::bullet
