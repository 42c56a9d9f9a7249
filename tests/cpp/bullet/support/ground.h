#pragma once

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::test_support {

/// Meters: bodies that roll stay on it.
inline constexpr Vec3 kGroundHalf{1.0, 1.0, 0.05};

/// What bodies fall on: its top is at z = 0.
enum class Ground { kPlane, kBox, kModel };

inline const char* to_string(Ground ground) {
  switch (ground) {
    case Ground::kPlane:
      return "Plane";
    case Ground::kBox:
      return "Box";
    case Ground::kModel:
      return "Model";
  }
  return "";
}

template <class World>
btRigidBody& add_ground(World& world, Ground ground) {
  switch (ground) {
    case Ground::kPlane:
      return world.add(world.template make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
    case Ground::kBox:
      return world.add(world.template make<btBoxShape>(to_bullet(kGroundHalf)), 0,
                       {{}, {0, 0, -kGroundHalf.z}});
    case Ground::kModel:
      break;
  }
  static const auto slab = build_model(voxshell::test_support::make_box(kGroundHalf), 0.03);
  return world.add_model(slab, 0, {{}, {0, 0, -kGroundHalf.z}});
}

}  // namespace voxshell::bullet::test_support
