#pragma once

#include <cstdlib>
#include <memory>

#include "support/meshes.h"
#include "voxshell/model.h"

namespace voxshell::bullet::test_support {

using voxshell::test_support::Soup;

/// Ends the test program where the model is refused: for meshes that are meant to be fine.
inline std::shared_ptr<const Model> build_model(const Soup& soup, double voxel_size) {
  auto model = Model::build(soup.mesh(), {.voxel_size = voxel_size, .threads = 1});
  if (!model) std::abort();
  return *std::move(model);
}

/// The same by tolerance, whose edges are elements of their own.
inline std::shared_ptr<const Model> build_by_tolerance(const Soup& soup, double tolerance = 1e-4) {
  auto model = Model::build(soup.mesh(), {.tolerance = tolerance, .threads = 1});
  if (!model) std::abort();
  return *std::move(model);
}
inline std::shared_ptr<const Model> build_by_tolerance(const Vec3& half_of_box) {
  return build_by_tolerance(voxshell::test_support::make_box(half_of_box));
}

inline constexpr double kCubeHalf = 0.1;  ///< meters
inline constexpr double kBallRadius = 0.1;

inline std::shared_ptr<const Model> cube_model() {
  static const auto model =
      build_model(voxshell::test_support::make_box({kCubeHalf, kCubeHalf, kCubeHalf}), 0.01);
  return model;
}

inline std::shared_ptr<const Model> ball_model() {
  static const auto model =
      build_model(voxshell::test_support::make_icosphere(kBallRadius, 4), 0.005);
  return model;
}

/// The floor that plane and box stand for elsewhere: its top is at z = 0.
inline std::shared_ptr<const Model> slab_model() {
  static const auto model =
      build_model(voxshell::test_support::moved(voxshell::test_support::make_box({0.3, 0.3, 0.05}),
                                                {0, 0, -0.05}),
                  0.01);
  return model;
}

/// Not convex, no symmetry.
inline std::shared_ptr<const Model> blob_model() {
  static const auto model = build_model(voxshell::test_support::make_blob(0.1, 3), 0.008);
  return model;
}

inline std::shared_ptr<const Model> torus_model() {
  static const auto model =
      build_model(voxshell::test_support::make_torus(0.1, 0.03, 40, 16), 0.006);
  return model;
}

}  // namespace voxshell::bullet::test_support
