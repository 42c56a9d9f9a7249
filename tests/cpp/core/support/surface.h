#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "support/random.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::test_support {

/// Points spread evenly over a mesh's surface, at random.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(const TriangleMesh& mesh) : mesh_(mesh) {
    double area = 0.0;
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      area += length(cross(b - a, c - a));
      area_up_to_.push_back(area);
    }
  }

  struct Place {
    Vec3 point;
    std::size_t triangle;
  };

  Vec3 operator()(Random& random) const { return place(random).point; }

  Place place(Random& random) const {
    const double area = random.uniform(0.0, area_up_to_.back());
    const auto found = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), area);
    const auto index =
        std::min(static_cast<std::size_t>(found - area_up_to_.begin()), area_up_to_.size() - 1);
    const auto [a, b, c] = mesh_.corners(index);
    const double root = std::sqrt(random.unit());
    const double v = random.unit();
    return {(1.0 - root) * a + (root * (1.0 - v)) * b + (root * v) * c, index};
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<double> area_up_to_;
};

}  // namespace voxshell::test_support
