#include "mesh/surface_cutter.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "mesh/disjoint_sets.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

/// How far off the surface its sides are looked at, of the mesh's longest side: above the rounding.
constexpr double kAside = 1e-5;
/// But no farther than this fraction of a piece's width.
constexpr double kAsideOfWidth = 0.1;

constexpr std::size_t kCorners = 3;
std::size_t next(std::size_t corner) { return corner + 1 == kCorners ? 0 : corner + 1; }

Vec3 compute_normal(const std::array<Vec3, 3>& corners) {
  return normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
}

/// Parts of a mesh, each connected by its vertices.
struct Parts {
  std::vector<std::uint32_t> of;  ///< triangles
  std::vector<Bounds> boxes;
};

Parts find_parts(std::span<const Triangle> triangles, std::span<const Vec3> vertices) {
  DisjointSets sets(vertices.size());
  for (const Triangle& t : triangles) {
    sets.join(t[0], t[1]);
    sets.join(t[0], t[2]);
  }
  Parts parts;
  std::vector<std::uint32_t> number(vertices.size());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    if (sets.find(v) != v) continue;
    number[v] = static_cast<std::uint32_t>(parts.boxes.size());
    parts.boxes.emplace_back();
  }
  parts.of.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const std::uint32_t part = number[sets.find(t[0])];
    parts.of.push_back(part);
    for (const std::uint32_t vertex : t) parts.boxes[part].extend(vertices[vertex]);
  }
  return parts;
}

}  // namespace

bool SurfaceSides::is_hidden() const {
  return (front > 0.5 && back > 0.5) || (front < 0.5 - kUnsure && back < 0.5 - kUnsure);
}

bool SurfaceSides::is_surely_hidden_or_not() const {
  return std::abs(std::min(front, back) - 0.5) >= kUnsure;
}

/// Cuts a triangle and tells its pieces apart.
class SurfaceCutter::Division {
 public:
  using Cut = SelfCrossings::Line;
  using Polygon = std::vector<Vec3>;  // convex, counter-clockwise

  Division(const SurfaceCutter& cutter, std::uint32_t triangle, double finest, CutBudget& budget)
      : cutter_(cutter),
        budget_(budget),
        triangle_(triangle),
        normal_(cutter.crossings_.normal(triangle)),
        finest_(finest),
        smallest_(kSmallest *
                  length(bound_triangle(cutter.crossings_.corners(triangle)).extents())) {}

  /// A part that touches one of its longer sides touches both: its neighbors are as near.
  bool is_narrow(const Polygon& polygon) const { return width_of(polygon) <= cutter_.rounding(); }

  void divide(const Polygon& polygon) {
    divide(polygon, cutter_.crossings_.find_lines(triangle_), 0);
  }

  void divide(const Polygon& polygon, std::vector<Cut> cuts, int vain) {
    if (polygon.size() < kCorners || budget_.is_spent()) return;
    budget_.take(1 + cuts.size());
    const std::size_t before = cuts.size();
    cutter_.crossings_.clip(polygon, normal_, cuts);
    if (cuts.empty()) return decide(polygon);
    constexpr std::size_t kFew = 2;
    if (cuts.size() > kFew && is_deep_inside(polygon, cuts)) {
      has_hidden_ = true;
      return;
    }
    // Of many, most are far from one another.
    constexpr std::size_t kMany = 8;
    if (cuts.size() > kMany) {
      vain = cuts.size() < before ? 0 : vain + 1;
      if (vain <= kMostInVain && size_of(polygon) > smallest_) return halve(polygon, cuts, vain);
    }
    const auto longest = std::ranges::max_element(
        cuts, {}, [](const Cut& cut) { return squared_length(cut.to - cut.from); });
    const Cut along = *longest;
    cuts.erase(longest);
    const Vec3 across = normalized(cross(normal_, along.to - along.from));
    divide(keep_above(polygon, along.from, across), cuts, 0);
    divide(keep_above(polygon, along.from, -across), cuts, 0);
  }

  std::vector<std::array<Vec3, 3>> take_pieces() { return std::move(pieces_); }
  bool has_visible() const { return !pieces_.empty(); }
  bool has_hidden() const { return has_hidden_; }

 private:
  static constexpr double kSmallest = 1e-4;  // of the triangle
  /// How often in a row pieces are halved that have no fewer cuts than before.
  static constexpr int kMostInVain = 4;

  static double size_of(const Polygon& polygon) {
    Bounds box;
    for (const Vec3& corner : polygon) box.extend(corner);
    return length(box.extents());
  }

  /// The part of the polygon that lies above a line in its plane. Corners on the line stay what
  /// they are, so that no two corners are at the same place.
  Polygon keep_above(const Polygon& polygon, const Vec3& origin, const Vec3& up) const {
    const auto height_of = [&](const Vec3& p) {
      const double height = dot(p - origin, up);
      return std::abs(height) <= 0.5 * cutter_.rounding() ? 0.0 : height;
    };
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3& a = polygon[i];
      const Vec3& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      const double above = height_of(a);
      const double then = height_of(b);
      if (above >= 0.0) kept.push_back(a);
      if (above * then < 0.0) kept.push_back(a + above / (above - then) * (b - a));
    }
    return kept;
  }

  /// Across its longest side's direction.
  void halve(const Polygon& polygon, const std::vector<Cut>& cuts, int vain) {
    Vec3 along{};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 side = polygon[i + 1 == polygon.size() ? 0 : i + 1] - polygon[i];
      if (squared_length(side) > squared_length(along)) along = side;
    }
    along = normalized(along);
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const Vec3& corner : polygon) {
      least = std::min(least, dot(corner - polygon[0], along));
      most = std::max(most, dot(corner - polygon[0], along));
    }
    const Vec3 middle = polygon[0] + 0.5 * (least + most) * along;
    divide(keep_above(polygon, middle, along), cuts, vain);
    divide(keep_above(polygon, middle, -along), cuts, vain);
  }

  /// Twice the area over the length of the rim.
  static double width_of(const Polygon& polygon) {
    Vec3 doubled{};
    double rim = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3& a = polygon[i];
      const Vec3& b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      doubled += cross(a - polygon[0], b - polygon[0]);
      rim += length(b - a);
    }
    return length(doubled) / rim;
  }

  static Vec3 middle_of(const Polygon& polygon) {
    Vec3 middle{};
    for (const Vec3& corner : polygon) middle += corner / static_cast<double>(polygon.size());
    return middle;
  }

  SurfaceSides look_at(const Polygon& polygon) const {
    const Vec3 middle = middle_of(polygon);
    const double aside = std::min(cutter_.aside_, kAsideOfWidth * width_of(polygon));
    std::size_t steps = 0;
    const SurfaceSides sides =
        cutter_.look_from(middle + aside * normal_, middle - aside * normal_, steps);
    budget_.take(steps);
    return sides;
  }

  /// Whole winding numbers fall by one on the way out through each triangle that crosses the
  /// polygon: nowhere on it do they come down to zero.
  bool is_deep_inside(const Polygon& polygon, std::span<const Cut> cuts) const {
    if (!cutter_.is_balanced_) return false;
    const Vec3 middle = middle_of(polygon);
    const auto ways_out = std::ranges::count_if(
        cuts, [&](const Cut& cut) { return dot(middle - cut.from, cut.outward) <= 0.0; });
    const SurfaceSides sides = look_at(polygon);
    return std::min(sides.front, sides.back) > static_cast<double>(ways_out) + 1.5;
  }

  void decide(const Polygon& polygon) {
    if (is_narrow(polygon)) return;
    const SurfaceSides sides = look_at(polygon);
    if (!sides.is_surely_hidden_or_not() && size_of(polygon) > finest_) {
      halve(polygon, {}, 0);
    } else if (sides.is_hidden()) {
      has_hidden_ = true;
    } else {
      add_pieces(polygon);
    }
  }

  void add_pieces(const Polygon& polygon) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      const std::array<Vec3, 3> piece{polygon[0], polygon[i], polygon[i + 1]};
      if (compute_normal(piece) != Vec3{}) pieces_.push_back(piece);
    }
  }

  const SurfaceCutter& cutter_;
  CutBudget& budget_;
  std::uint32_t triangle_;
  Vec3 normal_;
  double finest_;
  double smallest_;
  bool has_hidden_ = false;
  std::vector<std::array<Vec3, 3>> pieces_;
};

SurfaceCutter::SurfaceCutter(const TriangleMesh& mesh, bool is_balanced, SelfCrossings crossings)
    : is_balanced_(is_balanced),
      aside_(std::max(kAside * mesh.bounds().extents()[mesh.bounds().longest_axis()],
                      2.0 * crossings.rounding())),
      winding_(mesh),
      crossings_(std::move(crossings)) {
  if (is_balanced) by_rays_.emplace(mesh);
}

SurfaceSides SurfaceCutter::look_from(const Vec3& front, const Vec3& back,
                                      std::size_t& steps) const {
  if (by_rays_) {
    if (const auto numbers = by_rays_->compute({front, back}, steps)) {
      return {static_cast<double>((*numbers)[0]), static_cast<double>((*numbers)[1])};
    }
  }
  constexpr std::size_t kMostNear = 1024;  // solid angles, about; the rest counts in groups
  steps += std::min(crossings_.size(), kMostNear);
  std::array<double, 2> numbers{};
  winding_.compute(std::array{front, back}, numbers);
  return {numbers[0], numbers[1]};
}

SurfaceSides SurfaceCutter::look_at(const Vec3& place, const Vec3& normal) const {
  std::size_t steps = 0;
  return look_from(place + aside_ * normal, place - aside_ * normal, steps);
}

SurfaceSides SurfaceCutter::look_at(std::uint32_t triangle) const {
  const auto& [a, b, c] = crossings_.corners(triangle);
  return look_at((a + b + c) / 3.0, crossings_.normal(triangle));
}

std::vector<std::array<Vec3, 3>> SurfaceCutter::cut(std::uint32_t triangle, double finest,
                                                    CutBudget& budget, bool& is_hidden) const {
  Division division(*this, triangle, finest, budget);
  const auto& corners = crossings_.corners(triangle);
  const Division::Polygon whole(corners.begin(), corners.end());
  if (!division.is_narrow(whole)) division.divide(whole);
  is_hidden = division.has_hidden() && !division.has_visible();
  if (!division.has_hidden() || !division.has_visible()) return {};
  return division.take_pieces();
}

std::vector<std::array<double, 2>> SurfaceCutter::cut_line(const Vec3& from, const Vec3& to,
                                                           const Vec3& normal) const {
  const Vec3 way = to - from;
  std::vector<double> ends{0.0, 1.0};
  Bounds box;
  box.extend(from);
  box.extend(to);
  crossings_.finder().visit(widen(box, rounding()), [&](std::uint32_t other) {
    const Vec3& n = crossings_.normal(other);
    if (n == Vec3{}) return;
    const auto& corners = crossings_.corners(other);
    const double height = dot(from - corners[0], n);
    const double slope = dot(way, n);
    if (std::abs(slope) <= rounding()) return;
    const double fraction = -height / slope;
    if (!(fraction > 0.0 && fraction < 1.0)) return;
    const Vec3 place = from + fraction * way;
    for (std::size_t i = 0; i < kCorners; ++i) {
      const Vec3 inward = normalized(cross(n, corners[next(i)] - corners[i]));
      if (dot(place - corners[i], inward) < -rounding()) return;
    }
    ends.push_back(fraction);
  });
  std::ranges::sort(ends);
  std::vector<std::array<double, 2>> visible;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if ((ends[i + 1] - ends[i]) * length(way) <= rounding()) continue;
    const Vec3 middle = from + 0.5 * (ends[i] + ends[i + 1]) * way;
    if (look_at(middle, normal).is_hidden()) continue;
    constexpr double kNoGap = 1e-9;
    if (!visible.empty() && ends[i] - visible.back()[1] <= kNoGap) {
      visible.back()[1] = ends[i + 1];
    } else {
      visible.push_back({ends[i], ends[i + 1]});
    }
  }
  return visible;
}

std::vector<std::uint32_t> find_near_parts(const TriangleMesh& mesh) {
  const Parts parts = find_parts(mesh.triangles(), mesh.vertices());
  if (parts.boxes.size() == 1) return {};
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const BoxFinder finder(parts.boxes);
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < parts.of.size(); ++i) {
    const Bounds box = widen(bound_triangle(mesh.corners(i)), kAside * longest);
    bool meets = false;
    finder.visit(box, [&](std::uint32_t part) { meets = meets || part != parts.of[i]; });
    if (meets) triangles.push_back(i);
  }
  return triangles;
}

bool SurfaceCutter::hides_any(std::span<const std::uint32_t> triangles, unsigned threads) const {
  std::atomic<bool> is_found = false;
  CutBudget budget(crossings_.size());
  constexpr std::size_t kChunk = 64;
  parallel_for((triangles.size() + kChunk - 1) / kChunk, threads, "distance field", {},
               [&](std::size_t chunk) {
                 const std::size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
                 for (std::size_t i = chunk * kChunk; i < end && !is_found; ++i) {
                   bool is_hidden = look_at(triangles[i]).is_hidden();
                   if (!is_hidden && crossings_.is_crossed(triangles[i])) {
                     constexpr double kWhole = std::numeric_limits<double>::infinity();
                     is_hidden = !cut(triangles[i], kWhole, budget, is_hidden).empty() || is_hidden;
                   }
                   if (is_hidden || budget.is_spent()) is_found = true;
                 }
               });
  return is_found;
}

}  // namespace voxshell
