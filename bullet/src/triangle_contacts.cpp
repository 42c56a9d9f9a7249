#include "triangle_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "transform_bounds.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

constexpr float kThird = 1.0f / 3.0f;
constexpr int kMostSplits = 64;
constexpr std::uint32_t kNone = UINT32_MAX;
constexpr std::size_t kLanes = 8;  ///< places that the field is asked for at once

Vec3f middle_of(const Vec3f& a, const Vec3f& b) { return 0.5f * (a + b); }

/// The four pieces that the middles of the edges make.
std::array<Triangle3f, 4> quarter(const Triangle3f& t) {
  const Vec3f ab = middle_of(t.a, t.b);
  const Vec3f bc = middle_of(t.b, t.c);
  const Vec3f ca = middle_of(t.c, t.a);
  return {{{ab, bc, ca}, {t.a, ab, ca}, {ab, t.b, bc}, {ca, bc, t.c}}};
}

Vec3f middle_of(const Triangle3f& t) { return kThird * (t.a + t.b + t.c); }

/// Eight vectors.
struct Lanes {
  EightFloats x, y, z;

  void set(std::size_t i, const Vec3f& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
  Vec3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

EightFloats squared_distances(const Lanes& p, const Lanes& q) {
  EightFloats squared;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = p.x[i] - q.x[i];
    const float y = p.y[i] - q.y[i];
    const float z = p.z[i] - q.z[i];
    squared[i] = x * x + y * y + z * z;
  }
  return squared;
}

EightFloats largest(const EightFloats& a, const EightFloats& b, const EightFloats& c) {
  EightFloats most;
  for (std::size_t i = 0; i < kLanes; ++i) most[i] = std::max(std::max(a[i], b[i]), c[i]);
  return most;
}

/// The contact normal at the deepest place of a triangle. Within the triangle, the field's gradient
/// is along the triangle's normal, but for the kinks that edges and corners make in the field:
/// there the gradient is that of a face beside them, and the triangle's normal is the better.
Vec3f deepest_normal(const Triangle3f& triangle, const Vec3f& place, const Vec3f& gradient) {
  const Vec3f area = cross(triangle.b - triangle.a, triangle.c - triangle.a);
  const float twice_area = length(area);
  if (!(twice_area > 0.0f)) return gradient;
  const Vec3f normal = area / twice_area;
  const auto is_beside = [&](const Vec3f& from, const Vec3f& to) {
    constexpr float kOfSize = 1e-4f;
    return dot(cross(to - from, place - from), normal) > kOfSize * twice_area;
  };
  const bool is_within = is_beside(triangle.a, triangle.b) && is_beside(triangle.b, triangle.c) &&
                         is_beside(triangle.c, triangle.a);
  const float agreement = dot(normal, gradient);
  constexpr float kMostKink = 0.5f;
  if (!is_within || std::abs(agreement) < kMostKink) return gradient;
  return agreement > 0.0f ? normal : -normal;
}

}  // namespace

float TriangleContacts::sample_spacing(const Model& model) {
  const Vec3 size = model.bounds().extents();
  return static_cast<float>(
      std::max(model.grid().voxel_size(), std::max({size.x, size.y, size.z}) / 32.0));
}

std::vector<Contact>& TriangleContacts::find(const btConcaveShape& mesh, const Model& model,
                                             const Pose& model_from_mesh, int level, float margin) {
  constexpr int kMostCellsAlongSide = 16;
  field_ = &model.grid();
  model_from_mesh_ = model_from_mesh;
  margin_ = margin;
  spacing_ = sample_spacing(model);
  const double reach = static_cast<double>(margin) + field_->interpolation_error();
  bounds_ = model.bounds();
  within_reach_ = {bounds_.lower - Vec3{reach, reach, reach},
                   bounds_.upper + Vec3{reach, reach, reach}};
  const Vec3 size = bounds_.extents();
  cell_size_ = std::max({size.x, size.y, size.z}) /
               std::min(1 << std::min(level - 1, 20), kMostCellsAlongSide);
  for (std::size_t k = 0; k < 3; ++k) {
    cells_[k] = static_cast<std::uint32_t>(
        std::max(1.0, std::ceil(size[static_cast<int>(k)] / cell_size_ - 1e-9)));
  }
  place_of_cell_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2], kNone);
  triangles_.clear();
  best_.clear();
  contacts_.clear();

  const Pose mesh_from_model = model_from_mesh.inverse();
  const Bounds in_mesh = transform_bounds(mesh_from_model, within_reach_);
  mesh.processAllTriangles(this, to_bullet(in_mesh.lower), to_bullet(in_mesh.upper));
  sample_triangles();

  std::ranges::sort(best_, {}, &CellBest::cell);
  refine_best();
  for (std::size_t i = 0; i < best_.size(); ++i) {
    const Refined* deepest = &refined_[2 * i];
    // A cell's places of least distance need not lie about its least piece: the next is tried, too.
    const Refined* other = deepest + 1;
    if (best_[i].count > 1 && !(best_[i].pieces[1].bound > deepest->distance) &&
        other->distance < deepest->distance) {
      deepest = other;
    }
    if (deepest->distance < margin_) {
      contacts_.push_back(contact_of(best_[i].cell, *deepest, mesh_from_model));
    }
  }
  return contacts_;
}

void TriangleContacts::processTriangle(btVector3* corners, int, int) {
  std::array<Vec3, 3> in_model;
  for (std::size_t k = 0; k < 3; ++k) {
    in_model[k] = model_from_mesh_.transform_point(from_bullet(corners[k]));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] =
        std::minmax({in_model[0][axis], in_model[1][axis], in_model[2][axis]});
    if (least > within_reach_.upper[axis] || most < within_reach_.lower[axis]) return;
  }
  triangles_.push_back({static_cast<Vec3f>(in_model[0]), static_cast<Vec3f>(in_model[1]),
                        static_cast<Vec3f>(in_model[2])});
}

/// Pieces that the field is asked about at once.
struct TriangleContacts::Batch {
  std::size_t count = 0;
  Lanes a{}, b{}, c{};  ///< corners
  std::array<std::uint32_t, kLanes> triangle;
  std::array<int, kLanes> splits;
  Lanes middle;
  EightFloats squared_edge;  ///< the longest
  GridField::BallValues values;

  void add(const Triangle3f& corners, std::uint32_t of_triangle, int splits_left) {
    a.set(count, corners.a);
    b.set(count, corners.b);
    c.set(count, corners.c);
    triangle[count] = of_triangle;
    splits[count] = splits_left;
    ++count;
  }

  /// The quarters of a piece; of slender ones the halves, which end as well-shaped pieces where the
  /// longest edge is halved.
  void add_parts(const Piece& whole) {
    const Triangle3f& t = whole.corners;
    const std::array<float, 3> edges{squared_length(t.b - t.a), squared_length(t.c - t.b),
                                     squared_length(t.a - t.c)};
    const auto longest = std::max_element(edges.begin(), edges.end());
    constexpr float kSlender = 4.0f;
    if (*longest < kSlender * *std::min_element(edges.begin(), edges.end())) {
      for (const Triangle3f& part : quarter(t)) add(part, whole.triangle, whole.splits - 1);
      return;
    }
    const auto halve = [&](const Vec3f& from, const Vec3f& to, const Vec3f& opposite) {
      const Vec3f halfway = middle_of(from, to);
      add({from, halfway, opposite}, whole.triangle, whole.splits - 1);
      add({halfway, to, opposite}, whole.triangle, whole.splits - 1);
    };
    switch (longest - edges.begin()) {
      case 0:
        return halve(t.a, t.b, t.c);
      case 1:
        return halve(t.b, t.c, t.a);
      default:
        return halve(t.c, t.a, t.b);
    }
  }

  /// Far from the surface, where margins are those of fast bodies, coarser samples will do.
  bool is_leaf(std::size_t i, float least_spacing) const {
    const float spacing = std::max(least_spacing, 0.5f * values.lower_bound[i]);
    return splits[i] == 0 || squared_edge[i] <= spacing * spacing;
  }

  void measure(const GridField& field) {
    EightPoints centres;
    for (std::size_t i = 0; i < kLanes; ++i) {
      middle.x[i] = kThird * (a.x[i] + b.x[i] + c.x[i]);
      middle.y[i] = kThird * (a.y[i] + b.y[i] + c.y[i]);
      middle.z[i] = kThird * (a.z[i] + b.z[i] + c.z[i]);
    }
    centres.coordinates = {middle.x, middle.y, middle.z};
    squared_edge =
        largest(squared_distances(b, a), squared_distances(c, b), squared_distances(a, c));
    EightFloats radii = largest(squared_distances(a, middle), squared_distances(b, middle),
                                squared_distances(c, middle));
    for (float& radius : radii) radius = std::sqrt(radius);
    values = field.bound_balls(centres, radii);
  }
};

/// Triangle by triangle, depth first; as many pieces as the field takes at once are split ahead.
void TriangleContacts::sample_triangles() {
  constexpr std::size_t kMostParts = 4;
  for (std::size_t first = 0; first < triangles_.size(); first += kLanes) {
    Batch roots;
    for (std::size_t i = first; i < std::min(first + kLanes, triangles_.size()); ++i) {
      roots.add(triangles_[i], static_cast<std::uint32_t>(i), kMostSplits);
    }
    roots.measure(*field_);
    take(roots);
    while (!waiting_.empty()) {
      Batch parts;
      while (!waiting_.empty() && !waiting_.back().is_leaf && parts.count + kMostParts <= kLanes) {
        parts.add_parts(waiting_.back());
        waiting_.pop_back();
      }
      if (parts.count > 0) {
        parts.measure(*field_);
        take(parts);
      }
      for (; !waiting_.empty() && waiting_.back().is_leaf; waiting_.pop_back()) {
        keep(waiting_.back());
      }
    }
  }
}

/// Measured pieces within the margin, in their order: leaves are kept, and from the first that is
/// none on, all wait.
void TriangleContacts::take(const Batch& batch) {
  std::size_t first = 0;
  const auto piece = [&](std::size_t i) -> Piece {
    return {{batch.a[i], batch.b[i], batch.c[i]},
            batch.middle[i],
            batch.triangle[i],
            batch.splits[i],
            batch.is_leaf(i, spacing_),
            batch.values.distance[i],
            batch.values.lower_bound[i]};
  };
  const auto is_within = [&](std::size_t i) { return batch.values.lower_bound[i] <= margin_; };
  for (; first < batch.count; ++first) {
    if (!is_within(first)) continue;
    if (!batch.is_leaf(first, spacing_)) break;
    keep(piece(first));
  }
  for (std::size_t i = batch.count; i-- > first;) {
    if (is_within(i)) waiting_.push_back(piece(i));
  }
}

void TriangleContacts::keep(const Piece& piece) {
  const std::uint32_t cell = cell_of(piece.middle);
  std::uint32_t& place = place_of_cell_[cell];
  if (place == kNone) {
    place = static_cast<std::uint32_t>(best_.size());
    best_.push_back({cell, margin_, 0, {}});
  }
  CellBest& best = best_[place];
  if (piece.bound > best.least) return;
  best.least = std::min(best.least, piece.distance);
  if (best.count == 0 || piece.distance < best.pieces[0].distance) {
    best.pieces[1] = best.pieces[0];
    best.pieces[0] = piece;
  } else if (best.count == 1 || piece.distance < best.pieces[1].distance) {
    best.pieces[1] = piece;
  } else {
    return;
  }
  best.count = std::min<std::size_t>(best.count + 1, 2);
}

/// Goes into the quarter of each piece whose middle is deeper, again and again; two pieces at once.
void TriangleContacts::refine_best() {
  constexpr int kQuarterings = 5;
  constexpr std::size_t kParts = kLanes / 2;
  refined_.resize(2 * best_.size());
  for (std::size_t i = 0; i < best_.size(); ++i) {
    const std::size_t count = best_[i].count;
    const std::span<Refined> pair = std::span(refined_).subspan(2 * i, 2);
    for (std::size_t j = 0; j < 2; ++j) {
      const Piece& piece = best_[i].pieces[std::min(j, count - 1)];
      pair[j] = {piece.corners, piece.triangle, piece.middle, piece.distance};
    }
    const auto take = [](Refined& refined, const Vec3f& place, float distance) {
      if (!(distance < refined.distance)) return;
      refined.distance = distance;
      refined.deepest = place;
    };
    EightPoints places;
    for (int k = 0; k < kQuarterings; ++k) {
      std::array<std::array<Triangle3f, kParts>, 2> quarters;
      for (std::size_t j = 0; j < 2; ++j) {
        quarters[j] = quarter(pair[j].piece);
        for (std::size_t q = 0; q < kParts; ++q) {
          places.set(kParts * j + q, middle_of(quarters[j][q]));
        }
      }
      const EightFloats distances = field_->distances(places);
      for (std::size_t j = 0; j < 2; ++j) {
        const auto of_quarters = std::span(distances).subspan(kParts * j, kParts);
        for (std::size_t q = 0; q < kParts; ++q) {
          take(pair[j], middle_of(quarters[j][q]), of_quarters[q]);
        }
        const auto lowest = std::ranges::min_element(of_quarters);
        pair[j].piece = quarters[j][static_cast<std::size_t>(lowest - of_quarters.begin())];
      }
    }
    const auto corners_of = [](const Triangle3f& t) { return std::array{t.a, t.b, t.c}; };
    for (std::size_t j = 0; j < 2; ++j) {
      const auto corners = corners_of(pair[j].piece);
      for (std::size_t q = 0; q < corners.size(); ++q) places.set(kParts * j + q, corners[q]);
    }
    const EightFloats distances = field_->distances(places);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto corners = corners_of(pair[j].piece);
      for (std::size_t q = 0; q < corners.size(); ++q) {
        take(pair[j], corners[q], distances[kParts * j + q]);
      }
    }
  }
}

Contact TriangleContacts::contact_of(std::uint32_t cell, const Refined& refined,
                                     const Pose& mesh_from_model) const {
  const Vec3f outwards = normalized(field_->gradient(refined.deepest));
  const Vec3f normal = deepest_normal(triangles_[refined.triangle], refined.deepest, outwards);
  return {cell, -refined.distance,
          static_cast<Vec3f>(mesh_from_model.transform_point(static_cast<Vec3>(refined.deepest))),
          static_cast<Vec3f>(mesh_from_model.rotate(static_cast<Vec3>(normal)))};
}

std::uint32_t TriangleContacts::cell_of(const Vec3f& p) const {
  std::array<std::uint32_t, 3> index{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const double place = (static_cast<double>(p[axis]) - bounds_.lower[axis]) / cell_size_;
    index[k] =
        static_cast<std::uint32_t>(std::clamp(place, 0.0, static_cast<double>(cells_[k] - 1)));
  }
  return (index[2] * cells_[1] + index[1]) * cells_[0] + index[0];
}

}  // namespace voxshell::bullet
