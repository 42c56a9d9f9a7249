#include "mesh/repair.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "mesh/edges.h"
#include "mesh/t_vertices.h"

namespace voxshell {
namespace {

/// Repeated triangles that face the same way, in the order of the mesh, are left out.
std::vector<Triangle> drop_copies(std::span<const Triangle> triangles) {
  // The smallest vertex first: the same order around says the same side.
  const auto rotated = [](Triangle t) {
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    return t;
  };
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Triangle> keys;
  keys.reserve(triangles.size());
  for (const Triangle& t : triangles) keys.push_back(rotated(t));
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
  });
  std::vector<bool> is_copy(triangles.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i) {
    is_copy[order[i]] = keys[order[i]] == keys[order[i - 1]];
  }
  std::vector<Triangle> kept;
  kept.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_copy[i]) kept.push_back(triangles[i]);
  }
  return kept;
}

/// Triangles joined by edges, each turned or not against the first of its part.
class Parts {
 public:
  explicit Parts(std::size_t count)
      : parent_(count), is_turned_(count, false), is_one_sided_(count, false) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  struct Member {
    std::uint32_t part;
    bool is_turned;
  };

  Member find(std::uint32_t i) {
    bool is_turned = false;
    std::uint32_t root = i;
    while (parent_[root] != root) {
      is_turned = is_turned != is_turned_[root];
      root = parent_[root];
    }
    // All on the way now lead there at once.
    bool left = is_turned;
    while (parent_[i] != root && i != root) {
      const std::uint32_t above = parent_[i];
      const bool step = is_turned_[i];
      parent_[i] = root;
      is_turned_[i] = left;
      left = left != step;
      i = above;
    }
    return {root, is_turned};
  }

  /// `differ`: one is to be turned against the other.
  void join(std::uint32_t a, std::uint32_t b, bool differ) {
    const Member of_a = find(a);
    const Member of_b = find(b);
    const bool turns = (of_a.is_turned != of_b.is_turned) != differ;
    if (of_a.part == of_b.part) {
      if (turns) is_one_sided_[of_a.part] = true;
      return;
    }
    const auto [low, high] = std::minmax(of_a.part, of_b.part);
    parent_[high] = low;
    is_turned_[high] = turns;
    if (is_one_sided_[high]) is_one_sided_[low] = true;
  }

  bool is_one_sided(std::uint32_t part) const { return is_one_sided_[part]; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<bool> is_turned_;  ///< against the parent
  std::vector<bool> is_one_sided_;
};

/// Which triangles are to be turned.
std::vector<bool> find_wrongly_turned(const TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles().size();
  Parts parts(count);
  const auto sides = sort_sides(mesh.triangles(), mesh.vertices().size());
  visit_edges(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() != 2) return;
    parts.join(edge[0].triangle, edge[1].triangle, edge[0].is_forward == edge[1].is_forward);
  });
  std::vector<std::array<double, 2>> areas(count, {0.0, 0.0});  // of parts: not turned, turned
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const auto [part, is_turned] = parts.find(i);
    areas[part][is_turned ? 1 : 0] += length(cross(b - a, c - a));
  }
  std::vector<bool> is_wrong(count, false);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [part, is_turned] = parts.find(i);
    const bool turned_are_wrong = areas[part][1] <= areas[part][0];
    is_wrong[i] = !parts.is_one_sided(part) && is_turned == turned_are_wrong;
  }
  return is_wrong;
}

/// By how many triangles more run one way along edges than the other, over all edges.
std::size_t count_unbalanced(std::span<const Triangle> triangles, std::size_t vertices) {
  std::size_t count = 0;
  const auto sides = sort_sides(triangles, vertices);
  visit_edges(sides, [&](std::span<const TriangleSide> edge) {
    int sum = 0;
    for (const TriangleSide& side : edge) sum += side.is_forward ? 1 : -1;
    count += static_cast<std::size_t>(std::abs(sum));
  });
  return count;
}

}  // namespace

RepairedMesh take_as_it_is(TriangleMesh mesh) {
  RepairedMesh repaired{.mesh = std::move(mesh), .found = {}};
  repaired.found = repaired.mesh.compute_defects();
  repaired.is_closed = repaired.found.is_closed();
  const TriangleMesh& taken = repaired.mesh;
  repaired.is_balanced =
      repaired.is_closed || count_unbalanced(taken.triangles(), taken.vertices().size()) == 0;
  return repaired;
}

RepairedMesh repair_mesh(const TriangleMesh& mesh) {
  RepairedMesh repaired = take_as_it_is(mesh);
  if (repaired.is_closed) return repaired;
  std::vector<Triangle> distinct = drop_copies(mesh.triangles());
  // Parts that lie side by side may share such a triangle, and would be open without it.
  const std::size_t vertices = mesh.vertices().size();
  if (count_unbalanced(distinct, vertices) > count_unbalanced(mesh.triangles(), vertices)) {
    distinct.assign(mesh.triangles().begin(), mesh.triangles().end());
  }
  // Vertices of copies are those of the first: none is left without a triangle.
  auto changed =
      TriangleMesh::from_parts({mesh.vertices().begin(), mesh.vertices().end()}, distinct);
  if (!changed) return repaired;
  std::vector<Triangle> triangles = cut_at_t_vertices(*changed);
  if (count_unbalanced(triangles, vertices) < count_unbalanced(distinct, vertices)) {
    changed = TriangleMesh::from_parts({mesh.vertices().begin(), mesh.vertices().end()}, triangles);
    if (!changed) return repaired;
  } else {
    triangles = std::move(distinct);
  }
  const std::vector<bool> is_wrong = find_wrongly_turned(*changed);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (is_wrong[i]) std::swap(triangles[i][1], triangles[i][2]);
  }
  changed = TriangleMesh::from_parts({mesh.vertices().begin(), mesh.vertices().end()},
                                     std::move(triangles));
  if (!changed) return repaired;
  const MeshDefects found = repaired.found;
  repaired = take_as_it_is(*std::move(changed));
  repaired.found = found;
  return repaired;
}

}  // namespace voxshell
