#include "triangle_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "transform_bounds.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

constexpr float kThird = 1.0f / 3.0f;
constexpr int kMostSplits = 64;

Vec3f middle_of(const Vec3f& a, const Vec3f& b) { return 0.5f * (a + b); }

/// The four pieces that the middles of the edges make.
std::array<Triangle3f, 4> quarter(const Triangle3f& t) {
  const Vec3f ab = middle_of(t.a, t.b);
  const Vec3f bc = middle_of(t.b, t.c);
  const Vec3f ca = middle_of(t.c, t.a);
  return {{{ab, bc, ca}, {t.a, ab, ca}, {ab, t.b, bc}, {ca, bc, t.c}}};
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
  least_in_cell_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2], margin);
  triangles_.clear();
  samples_.clear();
  contacts_.clear();

  const Pose mesh_from_model = model_from_mesh.inverse();
  const Bounds in_mesh = transform_bounds(mesh_from_model, within_reach_);
  mesh.processAllTriangles(this, to_bullet(in_mesh.lower), to_bullet(in_mesh.upper));

  std::sort(samples_.begin(), samples_.end(), [](const Sample& a, const Sample& b) {
    return std::tie(a.cell, a.distance, a.triangle) < std::tie(b.cell, b.distance, b.triangle);
  });
  // A cell's places of least distance need not lie about its least sample: try a few.
  constexpr int kTries = 2;
  for (auto first = samples_.begin(); first != samples_.end();) {
    const auto last =
        std::find_if(first, samples_.end(), [&](const Sample& s) { return s.cell != first->cell; });
    const auto tried = last - first > kTries ? first + kTries : last;
    Contact best = deepest_near(*first, mesh_from_model);
    for (auto other = first + 1; other != tried; ++other) {
      if (other->bound > -best.depth) continue;
      const Contact contact = deepest_near(*other, mesh_from_model);
      if (contact.depth > best.depth) best = contact;
    }
    if (best.depth > -margin_) contacts_.push_back(best);
    first = last;
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
  sample(triangles_.back(), kMostSplits);
}

void TriangleContacts::sample(const Triangle3f& piece, int splits) {
  const Vec3f centre = kThird * (piece.a + piece.b + piece.c);
  const float radius =
      std::sqrt(std::max({squared_length(piece.a - centre), squared_length(piece.b - centre),
                          squared_length(piece.c - centre)}));
  const float bound = field_->lower_bound(centre, radius);
  if (!(bound <= margin_)) return;
  const std::array<float, 3> edges{squared_length(piece.b - piece.a),
                                   squared_length(piece.c - piece.b),
                                   squared_length(piece.a - piece.c)};
  const auto longest = std::max_element(edges.begin(), edges.end());
  // Far from the surface, where margins are those of fast bodies, coarser samples will do.
  const float spacing = std::max(spacing_, 0.5f * bound);
  if (*longest <= spacing * spacing || splits == 0) {
    const std::uint32_t cell = cell_of(centre);
    float& least = least_in_cell_[cell];
    if (bound > least) return;
    const float distance = field_->distance(centre);
    least = std::min(least, distance);
    samples_.push_back(
        {cell, distance, bound, static_cast<std::uint32_t>(triangles_.size() - 1), piece});
    return;
  }
  constexpr float kSlender = 4.0f;
  if (*longest < kSlender * *std::min_element(edges.begin(), edges.end())) {
    for (const Triangle3f& part : quarter(piece)) sample(part, splits - 1);
    return;
  }
  // Slender triangles end as well-shaped pieces where their longest edge is halved.
  const auto halve = [&](const Vec3f& from, const Vec3f& to, const Vec3f& opposite) {
    const Vec3f middle = middle_of(from, to);
    sample({from, middle, opposite}, splits - 1);
    sample({middle, to, opposite}, splits - 1);
  };
  switch (longest - edges.begin()) {
    case 0:
      return halve(piece.a, piece.b, piece.c);
    case 1:
      return halve(piece.b, piece.c, piece.a);
    default:
      return halve(piece.c, piece.a, piece.b);
  }
}

/// Goes into the quarter of the piece whose middle is deeper, again and again.
Contact TriangleContacts::deepest_near(const Sample& sample, const Pose& mesh_from_model) const {
  constexpr int kQuarterings = 5;
  Triangle3f piece = sample.around;
  Vec3f deepest = kThird * (piece.a + piece.b + piece.c);
  float least = sample.distance;
  const auto look_at = [&](const Vec3f& p) {
    const float distance = field_->distance(p);
    if (distance < least) {
      least = distance;
      deepest = p;
    }
    return distance;
  };
  for (int i = 0; i < kQuarterings; ++i) {
    const std::array<Triangle3f, 4> quarters = quarter(piece);
    float lowest = 0.0f;
    for (std::size_t k = 0; k < quarters.size(); ++k) {
      const Triangle3f& q = quarters[k];
      const float distance = look_at(kThird * (q.a + q.b + q.c));
      if (k == 0 || distance < lowest) {
        lowest = distance;
        piece = q;
      }
    }
  }
  for (const Vec3f& corner : {piece.a, piece.b, piece.c}) look_at(corner);

  const Vec3f outwards = normalized(field_->gradient(deepest));
  const Vec3f normal = deepest_normal(triangles_[sample.triangle], deepest, outwards);
  return {sample.cell, -least,
          static_cast<Vec3f>(mesh_from_model.transform_point(static_cast<Vec3>(deepest))),
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
