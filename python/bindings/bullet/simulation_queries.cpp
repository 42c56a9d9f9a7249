#include <algorithm>

#include "bullet/simulation.h"
#include "bullet/simulation_parts.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::python {
using bullet::from_bullet;
using bullet::to_bullet;

namespace {

/// Collects the points of a contact test.
class ContactList : public btCollisionWorld::ContactResultCallback {
 public:
  explicit ContactList(double margin) { m_closestDistanceThreshold = margin; }

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                           const btCollisionObjectWrapper* b, int, int) override {
    if (point.getDistance() > m_closestDistanceThreshold) return 0.0;
    contacts.push_back({a->getCollisionObject()->getUserIndex(),
                        b->getCollisionObject()->getUserIndex(), point.m_index0,
                        from_bullet(point.getPositionWorldOnA()),
                        from_bullet(point.getPositionWorldOnB()),
                        from_bullet(point.m_normalWorldOnB), -point.getDistance(), 0.0, Vec3{}});
    return 0.0;
  }

  std::vector<SimulationContact> contacts;
};

}  // namespace

std::vector<RayHit> Simulation::cast_rays(const std::vector<Vec3>& starts,
                                          const std::vector<Vec3>& ends) const {
  // Bullet's own tree of bounds is one step old.
  struct Target {
    btCollisionObject* body;
    btVector3 lower;
    btVector3 upper;
  };
  std::vector<Target> targets;
  for (const auto& [number, body] : bodies_) {
    Target target{&body->rigid_body, {}, {}};
    body->shape.get()->getAabb(body->rigid_body.getWorldTransform(), target.lower, target.upper);
    targets.push_back(target);
  }
  std::vector<RayHit> hits;
  hits.reserve(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const btTransform start(btQuaternion::getIdentity(), to_bullet(starts[i]));
    const btTransform end(btQuaternion::getIdentity(), to_bullet(ends[i]));
    btCollisionWorld::ClosestRayResultCallback closest(start.getOrigin(), end.getOrigin());
    for (const Target& target : targets) {
      btScalar fraction = closest.m_closestHitFraction;
      btVector3 normal;
      if (!btRayAabb(start.getOrigin(), end.getOrigin(), target.lower, target.upper, fraction,
                     normal)) {
        continue;
      }
      btCollisionWorld::rayTestSingle(start, end, target.body, target.body->getCollisionShape(),
                                      target.body->getWorldTransform(), closest);
    }
    RayHit hit;
    hit.point = ends[i];
    if (closest.hasHit()) {
      hit = {closest.m_collisionObject->getUserIndex(), closest.m_closestHitFraction,
             starts[i] + closest.m_closestHitFraction * (ends[i] - starts[i]),
             from_bullet(closest.m_hitNormalWorld.normalized())};
    }
    hits.push_back(hit);
  }
  return hits;
}

Bounds Simulation::bounds(std::size_t body) const {
  btVector3 lower;
  btVector3 upper;
  bodies_[body].shape.get()->getAabb(bodies_[body].rigid_body.getWorldTransform(), lower, upper);
  return {from_bullet(lower), from_bullet(upper)};
}

std::vector<SimulationContact> Simulation::find_contacts(std::size_t a, std::size_t b,
                                                         double margin) const {
  const Bounds of_a = bounds(a);
  const Bounds of_b = bounds(b);
  const btVector3 reach(margin, margin, margin);
  if (!TestAabbAgainstAabb2(to_bullet(of_a.lower) - reach, to_bullet(of_a.upper) + reach,
                            to_bullet(of_b.lower), to_bullet(of_b.upper))) {
    return {};
  }
  ContactList list(margin);
  world_->contactPairTest(&bodies_[a].rigid_body, &bodies_[b].rigid_body, list);
  return std::move(list.contacts);
}

}  // namespace voxshell::python
