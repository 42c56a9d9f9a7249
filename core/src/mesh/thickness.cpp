#include "mesh/thickness.h"

#include <algorithm>

namespace voxshell {

double compute_thickness(const TriangleMesh& mesh) {
  const Vec3 sides = mesh.bounds().extents();
  return std::min({sides.x, sides.y, sides.z});
}

}  // namespace voxshell
