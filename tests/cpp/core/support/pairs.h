#pragma once

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/distance.h"
#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell::test_support {

inline PointShell make_shell(const Soup& soup, double spacing) {
  auto shell = PointShell::build(soup.mesh(), {.spacing = spacing});
  if (!shell) std::abort();
  return *std::move(shell);
}

inline GridField make_grid(const Soup& soup, double voxel_size) {
  auto field = GridField::build(soup.mesh(), {.voxel_size = voxel_size, .padding = 2 * voxel_size});
  if (!field) std::abort();
  return *std::move(field);
}

inline ConvexField make_convex(const Soup& soup) {
  auto field = ConvexField::create(soup.mesh());
  if (!field) std::abort();
  return *std::move(field);
}

/// Bodies of about a meter, of every kind that matters to queries: not convex, with a hole, with
/// sharp edges, flat.
inline const std::vector<PointShell>& shells() {
  static const auto* all = new std::vector<PointShell>{
      make_shell(make_torus(0.4, 0.12, 40, 20), 0.04), make_shell(make_l_shape(0.3), 0.035),
      make_shell(make_blob(0.35, 3), 0.05), make_shell(make_wedge(0.8, 0.05, 0.4), 0.04)};
  return *all;
}

inline const std::vector<Field>& fields() {
  static const auto* all = new std::vector<Field>{make_grid(make_torus(0.4, 0.12, 40, 20), 0.03),
                                                  make_grid(make_l_shape(0.3), 0.025),
                                                  make_grid(make_blob(0.35, 3), 0.035),
                                                  PlaneField{normalized(Vec3{1, -2, 3}), 0.2},
                                                  BoxField{{0.3, 0.5, 0.2}},
                                                  SphereField{0.4},
                                                  CapsuleField{0.2, 0.5},
                                                  CylinderField{0.3, 0.6},
                                                  ConeField{0.4, 0.7},
                                                  make_convex(make_icosphere(0.4, 1))};
  return *all;
}

/// The smallest distance of any point of the shell, by evaluating the field in its own frame.
inline double smallest_distance(const Field& field, const PointShell& shell,
                                const Pose& field_from_shell) {
  float smallest = std::numeric_limits<float>::infinity();
  std::visit(
      [&](const auto& typed) {
        for (const Vec3f& p : shell.points()) {
          const Vec3 in_field = field_from_shell.transform_point(static_cast<Vec3>(p));
          smallest = std::min(smallest, typed.distance(static_cast<Vec3f>(in_field)));
        }
      },
      field);
  return static_cast<double>(smallest);
}

/// A random pose at which the shell is `clearance` away from the field, about; negative: inside.
inline Pose make_pose_at(const Field& field, const PointShell& shell, double clearance,
                         Random& random) {
  Pose field_from_shell{random.rotation(), {}};
  Vec3 away = random.direction();
  if (const auto* plane = std::get_if<PlaneField>(&field)) away = plane->normal;
  field_from_shell.translation = random.uniform(0.0, 0.6) * away;
  QueryScratch scratch;
  for (int step = 0; step < 8; ++step) {
    const auto nearest = find_nearest(field, shell, field_from_shell, 1e9f, scratch);
    field_from_shell.translation += (clearance + static_cast<double>(nearest->depth)) * away;
  }
  return field_from_shell;
}

}  // namespace voxshell::test_support
