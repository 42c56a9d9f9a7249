#include "contact_manifold.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

void combine_materials(btManifoldPoint& point, const btCollisionObject* object0,
                       const btCollisionObject* object1) {
  // Through Bullet's pointers, which users may have set to rules of their own.
  point.m_combinedFriction = gCalculateCombinedFrictionCallback(object0, object1);
  point.m_combinedRollingFriction = gCalculateCombinedRollingFrictionCallback(object0, object1);
  point.m_combinedSpinningFriction = gCalculateCombinedSpinningFrictionCallback(object0, object1);
  const int flags = object0->getCollisionFlags() | object1->getCollisionFlags();
  if (flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING) {
    point.m_combinedContactDamping1 = gCalculateCombinedContactDampingCallback(object0, object1);
    point.m_combinedContactStiffness1 =
        gCalculateCombinedContactStiffnessCallback(object0, object1);
    point.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
  }
  if (flags & btCollisionObject::CF_HAS_FRICTION_ANCHOR) {
    point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
  }
  btPlaneSpace1(point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2);
}

void carry_over(btManifoldPoint& point, const btManifoldPoint& before, bool carries_on) {
  point.m_appliedImpulse = before.m_appliedImpulse;
  // What is left for ten iterations to find again in every step is what resting bodies rock by.
  if (carries_on) point.m_appliedImpulse /= static_cast<btScalar>(kWarmStartingFactor);
  point.m_prevRHS = before.m_prevRHS;
  point.m_appliedImpulseLateral1 = before.m_appliedImpulseLateral1;
  point.m_appliedImpulseLateral2 = before.m_appliedImpulseLateral2;
  point.m_userPersistentData = before.m_userPersistentData;
  point.m_lifeTime = before.m_lifeTime + 1;
}

}  // namespace

void fill_manifold(btPersistentManifold& manifold, std::span<const WorldContact> contacts,
                   const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
  assert(contacts.size() <= MANIFOLD_CACHE_SIZE);
  const bool swapped = manifold.getBody0() != a.getCollisionObject();
  const btCollisionObjectWrapper& wrap0 = swapped ? b : a;
  const btCollisionObjectWrapper& wrap1 = swapped ? a : b;
  const btTransform& world_from_0 = wrap0.getCollisionObject()->getWorldTransform();
  const btTransform& world_from_1 = wrap1.getCollisionObject()->getWorldTransform();

  std::array<btManifoldPoint, MANIFOLD_CACHE_SIZE> before;
  const int before_count = manifold.getNumContacts();
  for (int i = 0; i < before_count; ++i) {
    before[static_cast<std::size_t>(i)] = manifold.getContactPoint(i);
    // The point that takes over its id takes over the data too.
    manifold.getContactPoint(i).m_userPersistentData = nullptr;
  }
  // Not clearManifold(), which would tell gContactEndedCallback that the bodies have parted.
  manifold.setNumContacts(0);

  std::array<bool, MANIFOLD_CACHE_SIZE> carried{};
  for (const WorldContact& contact : contacts) {
    const btVector3 on_0 = to_bullet(swapped ? contact.point_b : contact.point_a);
    const btVector3 on_1 = to_bullet(swapped ? contact.point_a : contact.point_b);
    const btVector3 normal_on_1 = to_bullet(swapped ? -contact.normal : contact.normal);
    btManifoldPoint point(world_from_0.invXform(on_0), world_from_1.invXform(on_1), normal_on_1,
                          static_cast<btScalar>(-contact.depth));
    point.m_positionWorldOnA = on_0;
    point.m_positionWorldOnB = on_1;
    point.m_partId0 = wrap0.m_partId;
    point.m_partId1 = wrap1.m_partId;
    point.m_index0 = point.m_index1 = static_cast<int>(contact.id);
    combine_materials(point, wrap0.getCollisionObject(), wrap1.getCollisionObject());
    point.m_combinedRestitution = static_cast<btScalar>(contact.restitution);
    point.m_appliedImpulse = static_cast<btScalar>(contact.first_impulse);
    point.m_combinedRollingFriction =
        std::max(point.m_combinedRollingFriction, static_cast<btScalar>(contact.rolling_friction));
    if (contact.is_resting) {
      // Pulled back at once, bodies on four points rest less calmly.
      constexpr double kPulledBack = 0.75;
      point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
      point.m_positionWorldOnB -= to_bullet(kPulledBack * (swapped ? -contact.slip : contact.slip));
    }
    for (int i = 0; i < before_count; ++i) {
      const auto slot = static_cast<std::size_t>(i);
      if (!carried[slot] && before[slot].m_index0 == point.m_index0) {
        carry_over(point, before[slot], contact.carries_on);
        carried[slot] = true;
        break;
      }
    }
    // Points within the margin are predictive: Bullet asserts that others are in touch.
    const int index = manifold.addManifoldPoint(point, /*isPredictive=*/contact.depth <= 0.0);
    const int flags = wrap0.getCollisionObject()->getCollisionFlags() |
                      wrap1.getCollisionObject()->getCollisionFlags();
    if (gContactAddedCallback != nullptr &&
        (flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0) {
      gContactAddedCallback(manifold.getContactPoint(index), &wrap0, point.m_partId0,
                            point.m_index0, &wrap1, point.m_partId1, point.m_index1);
    }
  }
  for (int i = 0; i < before_count; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (!carried[slot] && before[slot].m_userPersistentData != nullptr &&
        gContactDestroyedCallback != nullptr) {
      gContactDestroyedCallback(before[slot].m_userPersistentData);
    }
  }
  const int count = manifold.getNumContacts();
  btPersistentManifold* const filled = &manifold;
  if (before_count == 0 && count > 0 && gContactStartedCallback != nullptr) {
    gContactStartedCallback(filled);
  }
  if (before_count > 0 && count == 0 && gContactEndedCallback != nullptr) {
    gContactEndedCallback(filled);
  }
  if (gContactProcessedCallback == nullptr) return;
  for (int i = 0; i < count; ++i) {
    gContactProcessedCallback(manifold.getContactPoint(i),
                              const_cast<btCollisionObject*>(manifold.getBody0()),
                              const_cast<btCollisionObject*>(manifold.getBody1()));
  }
}

}  // namespace voxshell::bullet
