#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "support/meshes.h"
#include "voxshell/vector.h"

namespace voxshell::test_support {

/// Boxes along the axes that may overlap, as one body: its mesh, and slow exact answers about it.
struct BoxUnion {
  struct Box {
    Vec3 lower, upper;

    bool contains(const Vec3& p) const {
      return p.x > lower.x && p.x < upper.x && p.y > lower.y && p.y < upper.y && p.z > lower.z &&
             p.z < upper.z;
    }
  };
  std::vector<Box> boxes;

  /// Twelve triangles a box.
  Soup soup() const {
    Soup all;
    for (const Box& box : boxes) {
      all = together(all,
                     moved(make_box(0.5 * (box.upper - box.lower)), 0.5 * (box.lower + box.upper)));
    }
    return all;
  }

  bool contains(const Vec3& p) const {
    return std::ranges::any_of(boxes, [&](const Box& box) { return box.contains(p); });
  }

  /// What bounds the body: each side of a box is cut along the sides of all, and a part that has
  /// the body on both its sides is left out.
  std::vector<Box> find_faces() const {
    constexpr double kAside = 1e-7;
    std::vector<Box> faces;
    for (const Box& box : boxes) {
      for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        const std::vector<double> us = cuts(box, u);
        const std::vector<double> vs = cuts(box, v);
        for (const bool upper : {false, true}) {
          for (std::size_t i = 0; i + 1 < us.size(); ++i) {
            for (std::size_t k = 0; k + 1 < vs.size(); ++k) {
              Box face = box;
              face.lower[axis] = face.upper[axis] = upper ? box.upper[axis] : box.lower[axis];
              face.lower[u] = us[i];
              face.upper[u] = us[i + 1];
              face.lower[v] = vs[k];
              face.upper[v] = vs[k + 1];
              Vec3 front = 0.5 * (face.lower + face.upper);
              Vec3 back = front;
              front[axis] += kAside;
              back[axis] -= kAside;
              if (contains(front) != contains(back)) faces.push_back(face);
            }
          }
        }
      }
    }
    return faces;
  }

  /// Signed, meters.
  double distance(const std::vector<Box>& faces, const Vec3& p) const {
    double squared = std::numeric_limits<double>::infinity();
    for (const Box& face : faces) {
      Vec3 off{};
      for (int axis = 0; axis < 3; ++axis) {
        off[axis] = p[axis] - std::clamp(p[axis], face.lower[axis], face.upper[axis]);
      }
      squared = std::min(squared, squared_length(off));
    }
    return contains(p) ? -std::sqrt(squared) : std::sqrt(squared);
  }

  static double area(const std::vector<Box>& faces) {
    double sum = 0.0;
    for (const Box& face : faces) {
      const Vec3 e = face.upper - face.lower;
      sum += e.x * e.y + e.y * e.z + e.z * e.x;
    }
    return sum;
  }

 private:
  std::vector<double> cuts(const Box& of, int axis) const {
    std::vector<double> at{of.lower[axis], of.upper[axis]};
    for (const Box& box : boxes) {
      for (const double end : {box.lower[axis], box.upper[axis]}) {
        if (end > of.lower[axis] && end < of.upper[axis]) at.push_back(end);
      }
    }
    std::ranges::sort(at);
    at.erase(std::unique(at.begin(), at.end()), at.end());
    return at;
  }
};

/// Corners lie in one another.
inline BoxUnion make_two_boxes() {
  return {{{{-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}}, {{0.01, 0.0, -0.01}, {0.11, 0.1, 0.09}}}};
}
/// A rod pierces a cube: its long sides are hidden in their middle alone, and it passes through the
/// middles of the cube's.
inline BoxUnion make_pierced_box() {
  return {
      {{{-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}}, {{-0.14, 0.009, 0.004}, {0.16, 0.017, 0.01}}}};
}
/// The side of a small box lies on that of a large one.
inline BoxUnion make_touching_boxes() {
  return {
      {{{-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}}, {{0.05, -0.015, -0.02}, {0.09, 0.03, 0.03}}}};
}
/// Side by side, and deeper in one another by half a millimeter than beside one another.
inline BoxUnion make_shallow_boxes() {
  return {{{{-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}},
           {{0.0495, -0.04, -0.045}, {0.15, 0.035, 0.04}}}};
}

}  // namespace voxshell::test_support
