#pragma once

#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "support/meshes.h"
#include "support/overlapping_boxes.h"
#include "support/random.h"
#include "voxshell/model.h"

namespace voxshell::test_support {

// Their meshes and poses come from operations that IEEE 754 rounds correctly, no sines: the same
// bits on every processor and with every C library.

/// Uniform over all rotations.
inline Matrix3 make_rotation(Random& random) {
  double w = 0.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double squared = 0.0;
  while (squared < 1e-4 || squared > 1.0) {
    w = random.uniform(-1.0, 1.0);
    x = random.uniform(-1.0, 1.0);
    y = random.uniform(-1.0, 1.0);
    z = random.uniform(-1.0, 1.0);
    squared = w * w + x * x + y * y + z * z;
  }
  const double s = 2.0 / squared;
  return {{1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
          {s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)},
          {s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)}};
}

/// A bumpy body of about `radius`, without symmetry.
inline Soup make_lump(double radius, int subdivisions) {
  Soup soup = make_icosphere(1.0, subdivisions);
  for (Vec3& v : soup.vertices) {
    v = (radius * (1.0 + 0.3 * v.x * v.y - 0.2 * v.y * v.z * v.z + 0.15 * v.z)) * v;
  }
  return soup;
}

struct TravelingModel {
  const char* name;
  std::shared_ptr<const Model> model;
};

/// Bodies of about half a meter; together they have every section of a model file.
inline const std::vector<TravelingModel>& traveling_models() {
  static const auto* all = [] {
    auto* models = new std::vector<TravelingModel>;
    const auto add = [&](const char* name, const Soup& soup, const ModelSettings& settings) {
      auto model = Model::build(soup.mesh(), settings);
      if (!model) std::abort();
      models->push_back({name, *std::move(model)});
    };
    add("lump_by_tolerance", make_lump(0.25, 3), {.tolerance = 2e-3});
    add("uniform_lump", make_lump(0.25, 3), {.resolution = 24, .target_points = 1500});
    add("open_lump", opened(make_lump(0.25, 3), 0.1), {.resolution = 20, .open = OpenMesh::kSolid});
    add("sheet", opened(make_lump(0.25, 2), 0.0), {.resolution = 24, .open = OpenMesh::kSheet});
    add("l_shape", make_l_shape(0.2), {.tolerance = 2e-3});
    add("overlapping_boxes", scaled(make_two_boxes().soup(), 3.0), {.resolution = 24});
    return models;
  }();
  return *all;
}

}  // namespace voxshell::test_support
