#include "mesh/row_winding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/text.h"

namespace voxshell {
namespace {

/// Rows are moved aside by this fraction of a step, so that they miss the edges of meshes that are
/// aligned with the grid; where one is hit all the same, the row is moved once more.
constexpr double kNudgeY = 1.234e-6;
constexpr double kNudgeZ = 2.718e-6;
constexpr int kMaxNudges = 8;

struct Place {
  double y;
  double z;
};

Place row_place(const RowGrid& rows, std::size_t j, std::size_t k, int nudges) {
  const double shift = rows.step * nudges;
  return {rows.origin.y + static_cast<double>(j) * rows.step + kNudgeY * shift,
          rows.origin.z + static_cast<double>(k) * rows.step + kNudgeZ * shift};
}

/// Twice the signed area of (a, b, place) seen along x. The corner with the smaller index comes
/// first, so both triangles of an edge get the same magnitude and a row passes on one side of it.
double edge_side(const TriangleMesh& mesh, std::uint32_t from, std::uint32_t to,
                 const Place& place) {
  const bool swapped = to < from;
  const Vec3& a = mesh.vertices()[swapped ? to : from];
  const Vec3& b = mesh.vertices()[swapped ? from : to];
  const double side = (b.y - a.y) * (place.z - a.z) - (b.z - a.z) * (place.y - a.y);
  return swapped ? -side : side;
}

struct Hit {
  double x;
  int sign;
};

/// Where the row at `place` crosses a triangle; a sign of 0 where it hits the rim.
std::optional<Hit> intersect(const TriangleMesh& mesh, const Triangle& t, const Place& place) {
  const double opposite_2 = edge_side(mesh, t[0], t[1], place);
  const double opposite_0 = edge_side(mesh, t[1], t[2], place);
  const double opposite_1 = edge_side(mesh, t[2], t[0], place);
  const double low = std::min({opposite_0, opposite_1, opposite_2});
  const double high = std::max({opposite_0, opposite_1, opposite_2});
  if (low < 0.0 && high > 0.0) return std::nullopt;
  if (low == 0.0 || high == 0.0) {
    // Corners in line along x are a point to the row, which it only meets with the neighbors'
    // rims.
    const Vec3 ab = mesh.vertices()[t[1]] - mesh.vertices()[t[0]];
    const Vec3 ac = mesh.vertices()[t[2]] - mesh.vertices()[t[0]];
    if (ab.y == 0.0 && ab.z == 0.0 && ac.y == 0.0 && ac.z == 0.0) return std::nullopt;
    return Hit{0.0, 0};
  }
  const double total = opposite_0 + opposite_1 + opposite_2;
  const auto vertices = mesh.vertices();
  const double x = (opposite_0 * vertices[t[0]].x + opposite_1 * vertices[t[1]].x +
                    opposite_2 * vertices[t[2]].x) /
                   total;
  return Hit{x, total > 0.0 ? 1 : -1};
}

/// Rows first to last (included) that a span of coordinates may meet.
struct RowSpan {
  std::size_t first;
  std::size_t last;
};

std::optional<RowSpan> rows_between(double low, double high, double origin, double step,
                                    std::size_t rows) {
  const double first = std::max(std::floor((low - origin) / step), 0.0);
  const double last = std::min(std::ceil((high - origin) / step), static_cast<double>(rows - 1));
  if (first > last) return std::nullopt;
  return RowSpan{static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
}

}  // namespace

Result<RowWinding> RowWinding::build(const TriangleMesh& mesh, const RowGrid& rows) {
  struct RowCrossing {
    std::size_t row;
    Crossing crossing;
  };
  std::vector<RowCrossing> found;
  std::vector<char> hits_rim(rows.count(), 0);
  for (const Triangle& t : mesh.triangles()) {
    Bounds box;
    for (const std::uint32_t corner : t) box.extend(mesh.vertices()[corner]);
    const auto span_y =
        rows_between(box.lower.y, box.upper.y, rows.origin.y, rows.step, rows.rows_y);
    const auto span_z =
        rows_between(box.lower.z, box.upper.z, rows.origin.z, rows.step, rows.rows_z);
    if (!span_y || !span_z) continue;
    for (std::size_t k = span_z->first; k <= span_z->last; ++k) {
      for (std::size_t j = span_y->first; j <= span_y->last; ++j) {
        const auto hit = intersect(mesh, t, row_place(rows, j, k, 1));
        if (!hit) continue;
        const std::size_t row = j + k * rows.rows_y;
        if (hit->sign == 0) {
          hits_rim[row] = 1;
        } else {
          found.push_back({row, {hit->x, hit->sign}});
        }
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const RowCrossing& a, const RowCrossing& b) {
    return a.row != b.row ? a.row < b.row : a.crossing.x < b.crossing.x;
  });

  RowWinding winding;
  winding.first_.reserve(rows.count() + 1);
  auto next = found.begin();
  for (std::size_t row = 0; row < rows.count(); ++row) {
    winding.first_.push_back(winding.crossings_.size());
    int balance = 0;
    for (; next != found.end() && next->row == row; ++next) {
      winding.crossings_.push_back(next->crossing);
      balance += next->crossing.sign;
    }
    bool is_sound = balance == 0 && hits_rim[row] == 0;
    for (int nudges = 2; !is_sound && nudges <= kMaxNudges; ++nudges) {
      winding.crossings_.resize(winding.first_.back());
      const Place place = row_place(rows, row % rows.rows_y, row / rows.rows_y, nudges);
      balance = 0;
      bool hit_rim = false;
      for (const Triangle& t : mesh.triangles()) {
        const auto hit = intersect(mesh, t, place);
        if (!hit) continue;
        hit_rim = hit_rim || hit->sign == 0;
        balance += hit->sign;
        winding.crossings_.push_back({hit->x, hit->sign});
      }
      is_sound = balance == 0 && !hit_rim;
      std::sort(winding.crossings_.begin() + static_cast<std::ptrdiff_t>(winding.first_.back()),
                winding.crossings_.end(),
                [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    }
    if (!is_sound) {
      const Place place = row_place(rows, row % rows.rows_y, row / rows.rows_y, 0);
      return Error{ErrorCode::kInvalidMesh,
                   format_text("mesh is not closed: a line along x at y = %.4g, z = %.4g meters "
                               "enters and leaves it a different number of times",
                               place.y, place.z)};
    }
  }
  winding.first_.push_back(winding.crossings_.size());
  return winding;
}

void RowWinding::compute(std::size_t row, std::span<const double> x, std::span<int> winding) const {
  std::size_t next = first_[row];
  const std::size_t end = first_[row + 1];
  // Signs ahead of a place sum up to its winding number; all of a row sum up to zero.
  int ahead = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (; next < end && crossings_[next].x <= x[i]; ++next) ahead -= crossings_[next].sign;
    winding[i] = ahead;
  }
}

}  // namespace voxshell
