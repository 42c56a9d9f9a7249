#include "contact_manifold.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <new>
#include <utility>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "contact_constants.h"
#include "turning_speed.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

/// Whether the solver will move the body in this step. Islands are put to sleep after contacts have
/// been found, and then keep the impulses that these have.
bool stays_awake(const btCollisionObject& object) {
  return object.isActive() && object.getActivationState() != WANTS_DEACTIVATION;
}

/// What a manifold's point leaves to that of the next step with its id.
struct CachedImpulse {
  int id;
  int life_time;
  btScalar impulse;
  btScalar impulse_lateral_1;
  btScalar impulse_lateral_2;
  btScalar right_hand_side;
  void* user_data;
  bool is_taken;

  /// Takes the user's data out of the point.
  static CachedImpulse take_from(btManifoldPoint& point) {
    return {point.m_index0,
            point.m_lifeTime,
            point.m_appliedImpulse,
            point.m_appliedImpulseLateral1,
            point.m_appliedImpulseLateral2,
            point.m_prevRHS,
            std::exchange(point.m_userPersistentData, nullptr),
            false};
  }

  void give_to(btManifoldPoint& point, bool keeps_impulse) {
    point.m_appliedImpulse = impulse;
    // What is left for ten iterations to find again in every step is what resting bodies rock by.
    if (keeps_impulse) point.m_appliedImpulse /= static_cast<btScalar>(kWarmStartingFactor);
    point.m_prevRHS = right_hand_side;
    point.m_appliedImpulseLateral1 = impulse_lateral_1;
    point.m_appliedImpulseLateral2 = impulse_lateral_2;
    point.m_userPersistentData = user_data;
    point.m_lifeTime = life_time + 1;
    is_taken = true;
  }
};

}  // namespace

Materials::Materials(const btCollisionObject& a, const btCollisionObject& b)
    : friction(gCalculateCombinedFrictionCallback(&a, &b)),
      rolling_friction(gCalculateCombinedRollingFrictionCallback(&a, &b)),
      spinning_friction(gCalculateCombinedSpinningFrictionCallback(&a, &b)) {
  const int of_objects = a.getCollisionFlags() | b.getCollisionFlags();
  if (of_objects & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING) {
    damping = gCalculateCombinedContactDampingCallback(&a, &b);
    stiffness = gCalculateCombinedContactStiffnessCallback(&a, &b);
    flags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
  }
  if (of_objects & btCollisionObject::CF_HAS_FRICTION_ANCHOR) {
    flags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
  }
}

ManifoldFiller::ManifoldFiller(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b)
    : a_(a),
      b_(b),
      materials_(*a.getCollisionObject(), *b.getCollisionObject()),
      stays_awake_(stays_awake(*a.getCollisionObject()) || stays_awake(*b.getCollisionObject())),
      tells_added_(gContactAddedCallback != nullptr &&
                   ((a.getCollisionObject()->getCollisionFlags() |
                     b.getCollisionObject()->getCollisionFlags()) &
                    btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0) {}

/// Whether b is the manifold's first body.
bool ManifoldFiller::is_swapped(const btPersistentManifold& manifold) const {
  return manifold.getBody0() != a_.getCollisionObject();
}

/// Appends the contact's point, which has no impulse yet.
btManifoldPoint& ManifoldFiller::add(btPersistentManifold& manifold,
                                     const WorldContact& contact) const {
  const bool swapped = is_swapped(manifold);
  const btCollisionObjectWrapper& wrap0 = swapped ? b_ : a_;
  const btCollisionObjectWrapper& wrap1 = swapped ? a_ : b_;
  const btVector3 on_0 = to_bullet(swapped ? contact.point_b : contact.point_a);
  const btVector3 on_1 = to_bullet(swapped ? contact.point_a : contact.point_b);
  const btVector3 normal_on_1 = to_bullet(swapped ? -contact.normal : contact.normal);
  // In its place: addManifoldPoint() would copy 200 to 400 bytes, and asserts that points touch.
  const int index = manifold.getNumContacts();
  manifold.setNumContacts(index + 1);
  btManifoldPoint& point = *new (&manifold.getContactPoint(index)) btManifoldPoint(
      wrap0.getCollisionObject()->getWorldTransform().invXform(on_0),
      wrap1.getCollisionObject()->getWorldTransform().invXform(on_1), normal_on_1,
      static_cast<btScalar>(-contact.depth));
  point.m_positionWorldOnA = on_0;
  point.m_positionWorldOnB = on_1;
  point.m_partId0 = wrap0.m_partId;
  point.m_partId1 = wrap1.m_partId;
  point.m_index0 = point.m_index1 = static_cast<int>(contact.id);
  point.m_combinedFriction = materials_.friction;
  point.m_combinedRollingFriction =
      std::max(materials_.rolling_friction, static_cast<btScalar>(contact.rolling_friction));
  point.m_combinedSpinningFriction = materials_.spinning_friction;
  if (materials_.flags & BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING) {
    point.m_combinedContactDamping1 = materials_.damping;
    point.m_combinedContactStiffness1 = materials_.stiffness;
  }
  point.m_contactPointFlags |= materials_.flags;
  btPlaneSpace1(point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2);
  point.m_combinedRestitution = static_cast<btScalar>(contact.restitution);
  point.m_appliedImpulse = static_cast<btScalar>(contact.first_impulse);
  set_turning_speed(point, static_cast<btScalar>(contact.turning_speed));
  if (contact.is_resting) {
    point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
    point.m_positionWorldOnB -= to_bullet(kPulledBack * (swapped ? -contact.slip : contact.slip));
  }
  return point;
}

void ManifoldFiller::fill(btPersistentManifold& manifold,
                          std::span<const WorldContact> contacts) const {
  assert(contacts.size() <= MANIFOLD_CACHE_SIZE);
  std::array<CachedImpulse, MANIFOLD_CACHE_SIZE> kept;
  const int before_count = manifold.getNumContacts();
  for (int i = 0; i < before_count; ++i) {
    kept[static_cast<std::size_t>(i)] = CachedImpulse::take_from(manifold.getContactPoint(i));
  }
  const std::span before(kept.data(), static_cast<std::size_t>(before_count));
  // Not clearManifold(), which would tell gContactEndedCallback that the bodies have parted.
  manifold.setNumContacts(0);

  for (const WorldContact& contact : contacts) {
    const auto place = static_cast<std::size_t>(manifold.getNumContacts());
    btManifoldPoint& point = add(manifold, contact);
    const auto is_same = [&](const CachedImpulse& cached) {
      return !cached.is_taken && cached.id == point.m_index0;
    };
    // Points that carry on keep their places, most of the time.
    const auto same = place < before.size() && is_same(before[place])
                          ? before.begin() + static_cast<std::ptrdiff_t>(place)
                          : std::ranges::find_if(before, is_same);
    if (same != before.end()) same->give_to(point, contact.keeps_impulse && stays_awake_);
    if (tells_added_) {
      const bool swapped = is_swapped(manifold);
      gContactAddedCallback(point, swapped ? &b_ : &a_, point.m_partId0, point.m_index0,
                            swapped ? &a_ : &b_, point.m_partId1, point.m_index1);
    }
  }
  for (const CachedImpulse& cached : before) {
    if (!cached.is_taken && cached.user_data != nullptr && gContactDestroyedCallback != nullptr) {
      gContactDestroyedCallback(cached.user_data);
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
