#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/closest_point_tree.h"
#include "support/meshes.h"
#include "support/random.h"
#include "support/surface.h"
#include "voxshell/point_shell.h"

namespace voxshell::test_support {

/// Ends the program if that fails.
inline PointShell build_shell(const TriangleMesh& mesh, const PointShellSettings& settings) {
  auto shell = PointShell::build(mesh, settings);
  EXPECT_TRUE(shell) << shell.error().message;
  if (!shell) std::abort();
  return *std::move(shell);
}

inline void expect_error(const Result<PointShell>& shell, ErrorCode code,
                         const std::string& reason) {
  ASSERT_FALSE(shell) << "accepted, but expected: " << reason;
  EXPECT_EQ(shell.error().code, code);
  EXPECT_NE(shell.error().message.find(reason), std::string::npos) << shell.error().message;
}

/// A mesh with a name for messages of tests.
struct NamedMesh {
  const char* name;
  TriangleMesh mesh;
};

/// Boxes, round bodies, edges, spikes and a thin plate, about a meter.
inline std::vector<NamedMesh> make_named_meshes() {
  Random random(90);
  const auto turned = [&](const Soup& soup) { return transformed(soup, random.pose(0.3)).mesh(); };
  std::vector<NamedMesh> all;
  all.push_back({"box", make_box({0.5, 0.3, 0.2}).mesh()});
  all.push_back({"turned box", turned(make_box({0.5, 0.3, 0.2}))});
  all.push_back({"tetrahedron", turned(make_corner_tetrahedron(1))});
  all.push_back({"L-shape", make_l_shape(0.5).mesh()});
  all.push_back({"sphere", make_icosphere(0.5, 3).mesh()});
  all.push_back({"torus", make_torus(0.6, 0.2, 40, 20).mesh()});
  all.push_back({"blob", turned(make_blob(0.5, 3))});
  all.push_back({"wedge", turned(make_wedge(1.0, 0.05, 0.5))});
  all.push_back({"spike", turned(make_spike(0.1, 1.0))});
  all.push_back({"plate", make_box({0.5, 0.4, 0.001}).mesh()});
  return all;
}

/// All that a shell promises about its points, whatever the settings.
inline void expect_sound(const PointShell& shell, const TriangleMesh& mesh,
                         const std::string& name) {
  SCOPED_TRACE(name + ", " + std::to_string(shell.size()) + " points");
  const double size = length(mesh.bounds().extents());
  const std::size_t n = shell.size();
  ASSERT_GT(n, 0u);
  ASSERT_EQ(shell.normals().size(), n);
  ASSERT_EQ(shell.areas().size(), n);
  ASSERT_EQ(shell.tree().point_count(), n);

  const ClosestPointTree surface(mesh);
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = static_cast<Vec3>(shell.points()[i]);
    ASSERT_LE(std::sqrt(surface.find_closest(p).squared_distance), 1e-6 * size);
    ASSERT_NEAR(length(shell.normals()[i]), 1.0f, 1e-6f);
    ASSERT_GT(shell.areas()[i], 0.0f);
  }

  // The normal is that of a triangle on which the point lies. By brute force, so not for all.
  for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, n / 300)) {
    const auto p = static_cast<Vec3>(shell.points()[i]);
    const auto normal = static_cast<Vec3>(shell.normals()[i]);
    bool found = false;
    for (std::size_t t = 0; t < mesh.triangles().size() && !found; ++t) {
      const auto corners = mesh.corners(t);
      const Vec3 outwards = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
      found = dot(normal, outwards) > 1 - 1e-6 && distance_to_triangle(p, corners) <= 1e-6 * size;
    }
    ASSERT_TRUE(found) << "point " << i;
  }

  double area = 0.0;
  for (const float a : shell.areas()) area += static_cast<double>(a);
  EXPECT_NEAR(area, mesh.compute_area(), 1e-5 * mesh.compute_area());

  std::vector<std::array<float, 3>> places;
  for (const Vec3f& p : shell.points()) places.push_back({p.x, p.y, p.z});
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::adjacent_find(places.begin(), places.end()), places.end()) << "repeated points";

  for (int level = 1; level <= shell.tree().level_count(); ++level) {
    const auto spheres = shell.tree().spheres(level);
    for (std::uint64_t i = 0; i < spheres.size(); ++i) {
      const PointRange range = shell.tree().cluster_points(level, i);
      for (std::uint32_t id = range.begin; id < range.end; ++id) {
        const Vec3 away =
            static_cast<Vec3>(shell.points()[id]) - static_cast<Vec3>(spheres[i].center);
        ASSERT_LE(length(away), static_cast<double>(spheres[i].radius));
      }
    }
  }
}

/// The points of a shell by cells of the surface that each may cover.
class NearPoints {
 public:
  explicit NearPoints(const PointShell& shell, double reach) : shell_(shell), reach_(reach) {
    for (std::uint32_t id = 0; id < shell.size(); ++id) {
      ids_[cell(static_cast<Vec3>(shell.points()[id]))].push_back(id);
    }
  }

  /// The distance to the nearest point that satisfies `accepts`; infinite if none is within reach.
  template <class Accepts>
  double distance(const Vec3& p, const Accepts& accepts) const {
    double nearest = std::numeric_limits<double>::infinity();
    const auto center = cell(p);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          ids_.find({center[0] + i % 3 - 1, center[1] + i / 3 % 3 - 1, center[2] + i / 9 - 1});
      if (found == ids_.end()) continue;
      for (const std::uint32_t id : found->second) {
        if (!accepts(id)) continue;
        nearest = std::min(nearest, length(static_cast<Vec3>(shell_.points()[id]) - p));
      }
    }
    return nearest <= reach_ ? nearest : std::numeric_limits<double>::infinity();
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell(const Vec3& p) const {
    Cell index;
    for (int axis = 0; axis < 3; ++axis) {
      index[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor(p[axis] / reach_));
    }
    return index;
  }

  const PointShell& shell_;
  double reach_;
  std::map<Cell, std::vector<std::uint32_t>> ids_;
};

/// No place of the surface is farther than sqrt(3) spacings from a point that does not face away
/// from it.
inline void expect_covers(const PointShell& shell, const TriangleMesh& mesh, Random& random,
                          const std::string& name, int places = 2000) {
  SCOPED_TRACE(name + ", spacing " + std::to_string(shell.spacing()));
  const SurfaceSampler surface(mesh);
  const double bound = std::sqrt(3.0) * shell.spacing() + 1e-6 * length(mesh.bounds().extents());
  const NearPoints near(shell, bound);
  double worst = 0.0;
  for (int i = 0; i < places; ++i) {
    const auto [p, triangle] = surface.place(random);
    const auto [a, b, c] = mesh.corners(triangle);
    const Vec3 normal = normalized(cross(b - a, c - a));
    const double distance = near.distance(p, [&](std::uint32_t id) {
      return dot(static_cast<Vec3>(shell.normals()[id]), normal) > -0.003;
    });
    ASSERT_LE(distance, bound) << "from " << p.x << ", " << p.y << ", " << p.z;
    worst = std::max(worst, distance);
  }
  // Where spacing is far above the body's size one point a side is enough.
  if (shell.size() > 100) {
    EXPECT_GT(worst, 0.3 * shell.spacing());
  }
}

}  // namespace voxshell::test_support
