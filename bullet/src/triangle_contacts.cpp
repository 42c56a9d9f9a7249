#include "triangle_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact_constants.h"
#include "transform_bounds.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

constexpr float kThird = 1.0f / 3.0f;
constexpr std::uint32_t kNone = UINT32_MAX;
constexpr std::size_t kLanes = 8;  ///< places that the field is asked for at once

Vec3f middle_of(const Vec3f& a, const Vec3f& b) { return 0.5f * (a + b); }

/// The four pieces that the middles of the edges make, as corners a, b, c.
template <class Use>
void for_each_quarter(const Triangle3f& t, const Use& use) {
  const Vec3f ab = middle_of(t.a, t.b);
  const Vec3f bc = middle_of(t.b, t.c);
  const Vec3f ca = middle_of(t.c, t.a);
  use(ab, bc, ca);
  use(t.a, ab, ca);
  use(ab, t.b, bc);
  use(ca, bc, t.c);
}

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

/// By value, so that compilers see through it.
float larger(float a, float b) { return a < b ? b : a; }

/// Unit length, on the side of `outwards`; zero for triangles without area, and where the place is
/// on an edge.
Vec3f normal_within(const Triangle3f& triangle, const Vec3f& place, const Vec3f& outwards) {
  const Vec3f area = cross(triangle.b - triangle.a, triangle.c - triangle.a);
  const float twice_area = length(area);
  if (!(twice_area > 0.0f)) return {};
  const Vec3f normal = area / twice_area;
  const auto is_beside = [&](const Vec3f& from, const Vec3f& to) {
    return dot(cross(to - from, place - from), normal) > kOnEdge * twice_area;
  };
  const bool is_within = is_beside(triangle.a, triangle.b) && is_beside(triangle.b, triangle.c) &&
                         is_beside(triangle.c, triangle.a);
  if (!is_within) return {};
  return dot(normal, outwards) > 0.0f ? normal : -normal;
}

/// Those of the model and what is within the margin of its surface.
Bounds bounds_within(const Model& model, float margin) {
  const double reach = static_cast<double>(margin) + model.grid().interpolation_error();
  const Vec3 around{reach, reach, reach};
  return {model.bounds().lower - around, model.bounds().upper + around};
}

}  // namespace

float TriangleContacts::sample_spacing(const Model& model) {
  const Vec3 size = model.bounds().extents();
  return static_cast<float>(
      std::max(model.grid().voxel_size(), kSampleOfSize * std::max({size.x, size.y, size.z})));
}

std::vector<Contact>& TriangleContacts::find(const btConcaveShape& mesh, const Model& model,
                                             const Pose& model_from_mesh, int level, float margin) {
  gather(mesh, model, model_from_mesh, margin);
  return find(model, model_from_mesh, level, margin);
}

void TriangleContacts::gather(const btConcaveShape& mesh, const Model& model,
                              const Pose& model_from_mesh, float margin) {
  corners_.clear();
  const Bounds in_mesh = transform_bounds(model_from_mesh.inverse(), bounds_within(model, margin));
  mesh.processAllTriangles(this, to_bullet(in_mesh.lower), to_bullet(in_mesh.upper));
}

void TriangleContacts::processTriangle(btVector3* corners, int, int) {
  corners_.push_back({from_bullet(corners[0]), from_bullet(corners[1]), from_bullet(corners[2])});
}

double TriangleContacts::distance(const Model& model, const Pose& model_from_mesh, float margin) {
  nearest_alone_ = true;
  const std::vector<Contact>& found = find(model, model_from_mesh, /*level=*/1, margin);
  nearest_alone_ = false;
  return found.empty() ? std::numeric_limits<double>::infinity()
                       : -static_cast<double>(found[0].depth);
}

std::vector<Contact>& TriangleContacts::find(const Model& model, const Pose& model_from_mesh,
                                             int level, float margin, float apart) {
  field_ = &model.grid();
  margin_ = margin;
  spacing_ = sample_spacing(model);
  bounds_ = model.bounds();
  within_reach_ = bounds_within(model, margin);
  const Vec3 size = bounds_.extents();
  cell_size_ = std::max({size.x, size.y, size.z}) /
               std::min(1 << std::min(level - 1, 20), kMostCellsAlongSide);
  for (std::size_t k = 0; k < 3; ++k) {
    cells_[k] = static_cast<std::uint32_t>(
        std::max(1.0, std::ceil(size[static_cast<int>(k)] / cell_size_ - 1e-9)));
  }
  place_of_cell_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2], kNone);
  best_.clear();
  contacts_.clear();

  read_triangles(model_from_mesh);
  sample_triangles();

  const Pose mesh_from_model = model_from_mesh.inverse();
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
      contacts_.push_back(contact_of(best_[i].cell, *deepest, apart, mesh_from_model));
    }
  }
  return contacts_;
}

/// To the model's frame, without those that the margin does not reach.
void TriangleContacts::read_triangles(const Pose& model_from_mesh) {
  triangles_.clear();
  for (const std::array<Vec3, 3>& corners : corners_) {
    std::array<Vec3, 3> in_model;
    for (std::size_t k = 0; k < 3; ++k) in_model[k] = model_from_mesh.transform_point(corners[k]);
    bool is_within = true;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] =
          std::minmax({in_model[0][axis], in_model[1][axis], in_model[2][axis]});
      if (least > within_reach_.upper[axis] || most < within_reach_.lower[axis]) is_within = false;
    }
    if (!is_within) continue;
    triangles_.push_back({static_cast<Vec3f>(in_model[0]), static_cast<Vec3f>(in_model[1]),
                          static_cast<Vec3f>(in_model[2])});
  }
}

/// Pieces that the field is asked about at once.
struct TriangleContacts::Batch {
  std::size_t count = 0;  ///< of those that are set; the others are of no importance
  Lanes a{}, b{}, c{};    ///< corners
  std::array<std::uint32_t, kLanes> triangle{};
  std::array<int, kLanes> splits{};
  EightPoints middles;
  EightFloats squared_edge{};  ///< the longest
  GridField::BallValues values{};

  Vec3f middle(std::size_t i) const {
    const auto& [x, y, z] = middles.coordinates;
    return {x[i], y[i], z[i]};
  }

  void add(const Vec3f& at_a, const Vec3f& at_b, const Vec3f& at_c, std::uint32_t of_triangle,
           int splits_left) {
    a.set(count, at_a);
    b.set(count, at_b);
    c.set(count, at_c);
    triangle[count] = of_triangle;
    splits[count] = splits_left;
    ++count;
  }

  /// The quarters of a piece; of slender ones the halves, which end as well-shaped pieces where the
  /// longest edge is halved.
  void add_parts(const Piece& whole) {
    const Triangle3f& t = whole.corners;
    const auto add_part = [&](const Vec3f& at_a, const Vec3f& at_b, const Vec3f& at_c) {
      add(at_a, at_b, at_c, whole.triangle, whole.splits - 1);
    };
    const std::array<float, 3> edges{squared_length(t.b - t.a), squared_length(t.c - t.b),
                                     squared_length(t.a - t.c)};
    const auto longest = std::max_element(edges.begin(), edges.end());
    if (*longest < kSlenderSquared * *std::min_element(edges.begin(), edges.end())) {
      for_each_quarter(t, add_part);
      return;
    }
    const auto halve = [&](const Vec3f& from, const Vec3f& to, const Vec3f& opposite) {
      const Vec3f halfway = middle_of(from, to);
      add_part(from, halfway, opposite);
      add_part(halfway, to, opposite);
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

  void read(std::size_t i, float least_spacing, Piece& piece) const {
    piece.corners.a = a[i];
    piece.corners.b = b[i];
    piece.corners.c = c[i];
    piece.middle = middle(i);
    piece.triangle = triangle[i];
    piece.splits = splits[i];
    piece.is_leaf = is_leaf(i, least_spacing);
    piece.distance = values.distance[i];
    piece.bound = values.lower_bound[i];
  }

  /// Far from the surface, where margins are those of fast bodies, coarser samples will do.
  bool is_leaf(std::size_t i, float least_spacing) const {
    const float spacing = std::max(least_spacing, kSampleOfBound * values.lower_bound[i]);
    return splits[i] == 0 || squared_edge[i] <= spacing * spacing;
  }

  /// All lanes at once, in one loop that compilers vectorise.
  void measure(const GridField& field) {
    EightFloats radii;
    auto& [x, y, z] = middles.coordinates;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Vec3f at_a = a[i];
      const Vec3f at_b = b[i];
      const Vec3f at_c = c[i];
      const Vec3f at = kThird * (at_a + at_b + at_c);
      x[i] = at.x;
      y[i] = at.y;
      z[i] = at.z;
      squared_edge[i] = larger(larger(squared_length(at_b - at_a), squared_length(at_c - at_b)),
                               squared_length(at_a - at_c));
      radii[i] = larger(larger(squared_length(at_a - at), squared_length(at_b - at)),
                        squared_length(at_c - at));
    }
    for (float& radius : radii) radius = std::sqrt(radius);
    values = field.bound_balls(middles, radii);
  }
};

/// Triangle by triangle, depth first; as many pieces as the field takes at once are split ahead.
void TriangleContacts::sample_triangles() {
  constexpr std::size_t kMostParts = 4;
  Batch batch;
  for (std::size_t first = 0; first < triangles_.size(); first += kLanes) {
    batch.count = 0;
    for (std::size_t i = first; i < std::min(first + kLanes, triangles_.size()); ++i) {
      const Triangle3f& t = triangles_[i];
      batch.add(t.a, t.b, t.c, static_cast<std::uint32_t>(i), kMostSplits);
    }
    batch.measure(*field_);
    take(batch);
    while (!waiting_.empty()) {
      batch.count = 0;
      while (!waiting_.empty() && !waiting_.back().is_leaf && batch.count + kMostParts <= kLanes) {
        batch.add_parts(waiting_.back());
        waiting_.pop_back();
      }
      if (batch.count > 0) {
        batch.measure(*field_);
        take(batch);
      }
      for (; !waiting_.empty() && waiting_.back().is_leaf; waiting_.pop_back()) {
        const Piece& leaf = waiting_.back();
        if (Piece* kept = room_for(leaf.middle, leaf.distance, leaf.bound)) *kept = leaf;
      }
    }
  }
}

/// Measured pieces within the margin, in their order: leaves are kept, and from the first that is
/// none on, all wait.
void TriangleContacts::take(const Batch& batch) {
  const auto is_within = [&](std::size_t i) {
    const float most = nearest_alone_ && !best_.empty() ? best_[0].least : margin_;
    return batch.values.lower_bound[i] <= most;
  };
  std::size_t first = 0;
  for (; first < batch.count; ++first) {
    if (!is_within(first)) continue;
    if (!batch.is_leaf(first, spacing_)) break;
    Piece* const kept = room_for(batch.middle(first), batch.values.distance[first],
                                 batch.values.lower_bound[first]);
    if (kept != nullptr) batch.read(first, spacing_, *kept);
  }
  for (std::size_t i = batch.count; i-- > first;) {
    if (is_within(i)) batch.read(i, spacing_, waiting_.emplace_back());
  }
}

/// Where a leaf is to be put, if it is among the best of its cell so far.
TriangleContacts::Piece* TriangleContacts::room_for(const Vec3f& middle, float distance,
                                                    float bound) {
  const std::uint32_t cell = cell_of(middle);
  std::uint32_t& place = place_of_cell_[cell];
  if (place == kNone) {
    place = static_cast<std::uint32_t>(best_.size());
    best_.push_back({cell, margin_, 0, {}});
  }
  CellBest& best = best_[place];
  if (bound > best.least) return nullptr;
  best.least = std::min(best.least, distance);
  std::size_t rank = 0;
  while (rank < best.count && !(distance < best.pieces[rank].distance)) ++rank;
  if (rank == best.pieces.size()) return nullptr;
  if (rank == 0 && best.count > 0) best.pieces[1] = best.pieces[0];
  best.count = std::min(best.count + 1, best.pieces.size());
  return &best.pieces[rank];
}

/// Goes into the quarter of each piece whose middle is deeper, again and again; two pieces at once.
void TriangleContacts::refine_best() {
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
      std::array<std::array<Vec3f, kParts>, 2> middles;
      for (std::size_t j = 0; j < 2; ++j) {
        std::size_t q = 0;
        for_each_quarter(pair[j].piece, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
          middles[j][q] = kThird * (a + b + c);
          places.set(kParts * j + q, middles[j][q]);
          ++q;
        });
      }
      const EightFloats distances = field_->distances(places);
      for (std::size_t j = 0; j < 2; ++j) {
        const auto of_quarters = std::span(distances).subspan(kParts * j, kParts);
        for (std::size_t q = 0; q < kParts; ++q) take(pair[j], middles[j][q], of_quarters[q]);
        const auto lowest = std::ranges::min_element(of_quarters) - of_quarters.begin();
        std::ptrdiff_t q = 0;
        Triangle3f into;
        for_each_quarter(pair[j].piece, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
          if (q++ == lowest) into = {a, b, c};
        });
        pair[j].piece = into;
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

/// Within the triangle, the field's gradient is along the triangle's normal, but for the kinks that
/// edges and corners make in the field: there the gradient is that of a face beside them, and the
/// triangle's normal is the better. Of a place that the model is still away from, the contact is
/// that of the triangle's plane and the model's point nearest to the place.
Contact TriangleContacts::contact_of(std::uint32_t cell, const Refined& refined, float apart,
                                     const Pose& mesh_from_model) const {
  const Vec3f outwards = normalized(field_->gradient(refined.deepest));
  const Vec3f of_triangle = normal_within(triangles_[refined.triangle], refined.deepest, outwards);
  const float agreement = dot(of_triangle, outwards);
  Vec3f place = refined.deepest;
  Vec3f normal = outwards;
  float distance = refined.distance;
  if (distance > apart && agreement > 0.0f) {
    normal = of_triangle;
    distance *= agreement;
    place = place - refined.distance * outwards + distance * normal;
  } else if (agreement >= kMostKink) {
    normal = of_triangle;
  }
  return {cell, -distance,
          static_cast<Vec3f>(mesh_from_model.transform_point(static_cast<Vec3>(place))),
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
