#include <algorithm>
#include <cstddef>

#include "voxshell/model.h"

namespace voxshell {

/// The deepest place on lines that lead straight in from some hundred points of the shell: thin
/// walls, which a lattice of places would miss, have one as well.
Vec3f Model::find_inner_point(const GridField& field, const PointShell& shell) {
  constexpr std::size_t kLines = 256;
  constexpr int kMostSteps = 64;
  constexpr float kLeast = 0.25f;  // of a voxel, a step
  const float least = kLeast * static_cast<float>(field.voxel_size());
  Vec3f deepest = shell.points()[0];
  float depth = -field.distance(deepest);
  const std::size_t stride = std::max<std::size_t>(shell.size() / kLines, 1);
  for (std::size_t i = 0; i < shell.size(); i += stride) {
    Vec3f place = shell.points()[i];
    float here = -field.distance(place);
    for (int step = 0; step < kMostSteps; ++step) {
      const Vec3f next = place - std::max(here, least) * shell.normals()[i];
      const float there = -field.distance(next);
      if (!(there > here)) break;
      place = next;
      here = there;
    }
    if (here > depth) {
      depth = here;
      deepest = place;
    }
  }
  return deepest;
}

}  // namespace voxshell
