#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "query/posed_field.h"
#include "voxshell/contacts.h"
#include "voxshell/point_shell.h"

namespace voxshell {

/// The radius about the shell's origin that holds all its points.
inline double compute_reach(const PointShell& shell) {
  const Sphere& root = shell.tree().spheres(1)[0];
  return length(static_cast<Vec3>(root.centre)) + static_cast<double>(root.radius);
}

/// Calls `visit` with the field as the shell sees it, whatever its type.
template <class Visit>
auto with_posed_field(const Field& field, const PointShell& shell, const Pose& field_from_shell,
                      const Visit& visit) {
  return std::visit(
      [&]<class F>(const F& typed) {
        return visit(PosedField<F>(typed, field_from_shell, compute_reach(shell)));
      },
      field);
}

/// The contact of point `id` at a given distance. Where the field has no gradient (a ridge inside
/// it), the shell's own normal says which way is out.
template <class Posed>
Contact make_contact(const Posed& posed, const PointShell& shell, std::uint32_t id,
                     float distance) {
  const Vec3f point = shell.points()[id];
  Vec3f normal = posed.normal(point);
  if (normal == Vec3f{}) normal = -shell.normals()[id];
  return {id, -distance, point, normal};
}

/// Walks the point-sphere tree and calls `visit(id)` on the points of every leaf that may hold one
/// nearer than `margin`, ascending by id, until it returns false. Returns false where it did.
template <class Posed, class Visit>
bool visit_points_below(const Posed& posed, const PointShell& shell, float margin,
                        const Visit& visit) {
  const PointSphereTree& tree = shell.tree();
  struct Node {
    std::uint64_t index;
    int level;
  };
  constexpr std::size_t kMostWaiting =
      (PointSphereTree::kBranching - 1) * PointSphereTree::kMaxLevel + 1;
  std::array<Node, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, 1};
  while (waiting > 0) {
    const Node node = stack[--waiting];
    if (!posed.may_contain_below(tree.spheres(node.level)[node.index], margin)) continue;
    if (node.level == tree.level_count()) {
      const PointRange range = tree.cluster_points(node.level, node.index);
      for (std::uint32_t id = range.begin; id < range.end; ++id) {
        if (!visit(id)) return false;
      }
      continue;
    }
    for (std::uint64_t child = PointSphereTree::kBranching; child-- > 0;) {
      stack[waiting++] = {PointSphereTree::kBranching * node.index + child, node.level + 1};
    }
  }
  return true;
}

}  // namespace voxshell
