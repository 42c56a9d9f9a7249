#include "field/enclosing_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "field/brick_entry.h"
#include "field/surface_bricks.h"
#include "mesh/distance_tree.h"
#include "mesh/edges.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::string_view kStage = "distance field";
constexpr std::size_t kNodes = kBrickCells + 1;
/// How large the specks are, voxels.
constexpr double kSpeck = 1e-3;

/// The visible part of a triangle, and whether its sides are inside.
struct Look {
  SurfaceSides sides;                       ///< at its middle
  bool is_hidden = false;                   ///< as a whole
  std::vector<std::array<Vec3, 3>> pieces;  ///< the visible ones, where only a part is visible

  /// Of neither side is it in doubt whether it is inside.
  bool is_clear() const {
    return std::abs(sides.front - 0.5) >= kUnsure && std::abs(sides.back - 0.5) >= kUnsure;
  }
};

/// The winding number jumps by one across the surface: from about 0 to 1 where it encloses
/// something, from -1/2 to 1/2 where it is a sheet.
double measure_confidence(const TriangleMesh& mesh, const std::vector<Look>& looks) {
  double clear = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const double area = length(cross(b - a, c - a));
    all += area;
    if (looks[i].is_clear()) clear += area;
  }
  return all > 0.0 ? clear / all : 0.0;
}

/// Edges that are not of exactly two triangles, as triangles without area.
std::vector<std::array<Vec3, 3>> find_faulty_edges(const TriangleMesh& mesh) {
  std::vector<std::array<Vec3, 3>> faulty;
  const auto sides = sort_sides(mesh.triangles(), mesh.vertices().size());
  visit_edges(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() == 2 && edge[0].is_forward != edge[1].is_forward) return;
    const Vec3& a = mesh.vertices()[edge[0].low];
    const Vec3& b = mesh.vertices()[edge[0].high];
    faulty.push_back({a, b, b});
  });
  return faulty;
}

/// Where the limit of the inside runs through a brick without a triangle near, meters; and through
/// which faces it goes on: bit 2 axis, plus 1 for the upper face.
struct Crossings {
  std::vector<Vec3> points;
  unsigned faces = 0;
  BrickSides sides;  ///< of its nodes
};

Crossings find_crossings(const std::array<std::size_t, 3>& brick, const BrickGrid& grid,
                         const InsideByWindingNumbers& inside, std::span<const float> distances) {
  constexpr std::size_t kCount = kNodes * kNodes * kNodes;
  constexpr std::array<std::size_t, 3> kStrides{1, kNodes, kNodes * kNodes};
  std::array<Vec3, kCount> nodes;
  std::array<double, kCount> numbers;
  const auto node_at = [&](const std::array<std::size_t, 3>& place) {
    return grid.node(kBrickCells * brick[0] + place[0], kBrickCells * brick[1] + place[1],
                     kBrickCells * brick[2] + place[2]);
  };
  const auto place_of = [](std::size_t node) {
    return std::array{node % kNodes, node / kNodes % kNodes, node / (kNodes * kNodes)};
  };
  for (std::size_t node = 0; node < kCount; ++node) nodes[node] = node_at(place_of(node));
  inside.compute(nodes, numbers);
  Crossings found;
  found.sides = decide_sides(numbers);
  for (std::size_t node = 0; node < kCount; ++node) {
    const auto place = place_of(node);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place[axis] == kBrickCells) continue;
      const std::size_t next = node + kStrides[axis];
      if (found.sides.is_inside[node] == found.sides.is_inside[next]) continue;
      if (distances[node] + distances[next] <= 1.0f + 1e-3f) continue;
      bool is_on_upper_face = false;
      for (std::size_t other = 0; other < 3; ++other) {
        if (other == axis) continue;
        if (place[other] == 0) found.faces |= 1u << (2 * other);
        if (place[other] == kBrickCells) {
          found.faces |= 1u << (2 * other + 1);
          is_on_upper_face = true;  // and told by the next brick
        }
      }
      if (is_on_upper_face) continue;
      const double fraction = (0.5 - numbers[node]) / (numbers[next] - numbers[node]);
      found.points.push_back(nodes[node] +
                             std::clamp(fraction, 0.0, 1.0) * (nodes[next] - nodes[node]));
    }
  }
  return found;
}

}  // namespace

std::optional<EnclosingSurface> find_enclosing_surface(
    const TriangleMesh& mesh, const std::shared_ptr<const SurfaceCutter>& cutter,
    const BrickGrid& grid, const InsideByWindingNumbers& inside, double least_confidence,
    unsigned threads, const Progress& progress) {
  const double h = grid.voxel_size;
  const std::size_t count = mesh.triangles().size();
  std::vector<Look> looks(count);
  const auto for_triangles = [&](const auto& visit) {
    constexpr std::size_t kChunk = 64;
    return parallel_for((count + kChunk - 1) / kChunk, threads, kStage, progress,
                        [&](std::size_t chunk) {
                          const std::size_t end = std::min(count, (chunk + 1) * kChunk);
                          for (std::size_t i = chunk * kChunk; i < end; ++i) {
                            visit(static_cast<std::uint32_t>(i));
                          }
                        });
  };
  if (!for_triangles([&](std::uint32_t i) { looks[i].sides = cutter->look_at(i); })) {
    return std::nullopt;
  }
  EnclosingSurface surface;
  surface.confidence = measure_confidence(mesh, looks);
  if (surface.confidence < least_confidence) return surface;
  CutBudget budget(count);
  const auto cut = [&](std::uint32_t i) {
    if (budget.is_spent()) return;
    Look& look = looks[i];
    look.is_hidden = look.sides.is_hidden();
    if (!look.sides.is_surely_hidden_or_not() || cutter->is_crossed(i)) {
      look.pieces = cutter->cut(i, h, budget, look.is_hidden);
    }
  };
  if (!for_triangles(cut)) return std::nullopt;
  if (budget.is_spent()) {
    surface.spent_steps = budget.steps();
    return surface;
  }
  std::vector<Vec3> vertices(mesh.vertices().begin(), mesh.vertices().end());
  std::vector<Triangle> triangles;
  std::vector<VisibleTriangle> visible;
  std::vector<std::array<Vec3, 3>> open = find_faulty_edges(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    const auto corners = mesh.corners(i);
    if (!looks[i].is_clear()) open.push_back(corners);
    if (looks[i].is_hidden || !looks[i].pieces.empty()) {
      if (surface.hidden_triangles++ == 0) {
        surface.first_hidden = (corners[0] + corners[1] + corners[2]) / 3.0;
      }
    }
    for (const auto& piece : looks[i].pieces) {
      const auto first = static_cast<std::uint32_t>(vertices.size());
      vertices.insert(vertices.end(), piece.begin(), piece.end());
      triangles.push_back({first, first + 1, first + 2});
      visible.push_back({static_cast<std::uint32_t>(i), false});
    }
    if (looks[i].is_hidden || !looks[i].pieces.empty()) continue;
    triangles.push_back(mesh.triangles()[i]);
    visible.push_back({static_cast<std::uint32_t>(i), true});
  }
  auto kept = TriangleMesh::create(vertices, triangles);
  if (!kept) return std::nullopt;
  if (surface.hidden_triangles > 0) {
    if (kept->triangles().size() != visible.size()) return std::nullopt;  // none lost a corner
    // Slivers narrower than the rounding enclose nothing: the rest of the mesh folds flat.
    const Vec3 extents = kept->bounds().extents();
    const double longest = extents[kept->bounds().longest_axis()];
    if (kept->compute_area() <= cutter->rounding() * longest) return std::nullopt;
    surface.visible = VisibleSurface{*kept, std::move(visible), cutter};
  }

  const DistanceTree tree(*kept, grid.origin, h, threads);
  // The limit leaves the mesh at such places; from there it is followed from brick to brick.
  std::vector<char> was_seen = find_surface_bricks(open, grid, 1.0);
  std::vector<std::size_t> bricks;
  for (std::size_t brick = 0; brick < grid.count(); ++brick) {
    if (was_seen[brick] != 0) bricks.push_back(brick);
  }
  std::vector<Vec3> caps;
  while (!bricks.empty()) {
    std::vector<Crossings> found(bricks.size());
    const auto follow = [&](std::size_t i) {
      const auto place = grid.place(bricks[i]);
      Vec3 center{};
      for (int axis = 0; axis < 3; ++axis) {
        center[axis] =
            (static_cast<double>(place[static_cast<std::size_t>(axis)]) + 0.5) * kBrickCells;
      }
      DistanceTree::Scratch scratch;
      std::array<float, cube(kNodes)> distances;
      tree.measure_brick(center, tree.find_nearest(center, 0).distance, scratch, distances);
      found[i] = find_crossings(place, grid, inside, distances);
    };
    if (!parallel_for(bricks.size(), threads, kStage, progress, follow)) return std::nullopt;
    std::vector<std::size_t> next;
    const std::array<std::size_t, 3> strides{1, grid.bricks[0], grid.bricks[0] * grid.bricks[1]};
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      caps.insert(caps.end(), found[i].points.begin(), found[i].points.end());
      surface.sides.emplace(bricks[i], found[i].sides);
      const auto place = grid.place(bricks[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool upper : {false, true}) {
          if ((found[i].faces >> (2 * axis + (upper ? 1 : 0)) & 1) == 0) continue;
          if (place[axis] == (upper ? grid.bricks[axis] - 1 : 0)) continue;
          const std::size_t other = upper ? bricks[i] + strides[axis] : bricks[i] - strides[axis];
          if (was_seen[other] != 0) continue;
          was_seen[other] = 1;
          next.push_back(other);
        }
      }
    }
    std::sort(next.begin(), next.end());
    bricks = std::move(next);
  }
  surface.caps = caps.size();
  for (const Vec3& cap : caps) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(),
                    {cap, cap + Vec3{kSpeck * h, 0.0, 0.0}, cap + Vec3{0.0, kSpeck * h, 0.0}});
    triangles.push_back({first, first + 1, first + 2});
  }
  auto closed = TriangleMesh::create(vertices, triangles);
  if (!closed) return std::nullopt;
  surface.mesh = *std::move(closed);
  return surface;
}

}  // namespace voxshell
