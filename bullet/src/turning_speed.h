#pragma once

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

namespace voxshell::bullet {

// The speed apart with which a contact is to end the step (see TurningContacts) is in a member of
// Bullet's points that Bullet reads for contacts with an ERP or a damping of their own alone.

inline bool has_own_erp(const btManifoldPoint& point) {
  constexpr int kOwn = BT_CONTACT_FLAG_HAS_CONTACT_ERP | BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
  return (point.m_contactPointFlags & kOwn) != 0;
}

/// m/s.
inline void set_turning_speed(btManifoldPoint& point, btScalar speed) {
  if (!has_own_erp(point)) point.m_contactERP = speed;
}

inline btScalar turning_speed_of(const btManifoldPoint& point) {
  return has_own_erp(point) ? btScalar(0) : point.m_contactERP;
}

}  // namespace voxshell::bullet
