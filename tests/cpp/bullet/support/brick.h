#pragma once

#include <cstdlib>
#include <memory>

#include "support/meshes.h"
#include "voxshell/model.h"

namespace voxshell::bullet::test_support {

inline constexpr Vec3 kBrickHalf{0.1, 0.05, 0.03};  ///< meters

/// By tolerance, with edge segments.
inline std::shared_ptr<const Model> brick_model() {
  static const auto model = [] {
    const auto brick = voxshell::test_support::make_box(kBrickHalf);
    auto built = Model::build(brick.mesh(), {.tolerance = 1e-4, .threads = 1});
    if (!built) std::abort();
    return *std::move(built);
  }();
  return model;
}

}  // namespace voxshell::bullet::test_support
