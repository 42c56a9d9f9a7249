#include "voxshell/convex_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include "base/serial.h"
#include "base/text.h"
#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {
namespace {

// Fractions of the mesh's longest side.
constexpr double kConvexTo = 1e-5;
constexpr double kCoplanarTo = 1e-6;
/// A triangle lower than this has no normal to trust, and its neighbors bound what it would.
constexpr double kLowest = 1e-10;
/// Between the normals of triangles of one face: those of slivers may be this far off.
constexpr double kCoplanarCosine = 0.5;
constexpr double kFarOut = std::numeric_limits<double>::infinity();

struct Face {
  Vec3 normal;
  double offset;
  std::size_t triangle;
};

struct RankedTriangle {
  double area;
  std::size_t index;
};

/// Largest first, so that what slivers there are join the faces that they lie in.
std::vector<RankedTriangle> rank_by_area(const TriangleMesh& mesh) {
  std::vector<RankedTriangle> ranked;
  ranked.reserve(mesh.triangles().size());
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    ranked.push_back({length(cross(b - a, c - a)) / 2.0, i});
  }
  std::sort(ranked.begin(), ranked.end(), [](const RankedTriangle& a, const RankedTriangle& b) {
    return a.area != b.area ? a.area > b.area : a.index < b.index;
  });
  return ranked;
}

double longest_edge(const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  return std::max({length(b - a), length(c - b), length(a - c)});
}

Error too_many_faces(const TriangleMesh& mesh) {
  return {ErrorCode::kTooLarge,
          format_text("a convex polyhedron of more than %zu faces is slower than a model; build a "
                      "model of this mesh of %zu triangles, or simplify it",
                      ConvexField::kMostFaces, mesh.triangles().size())};
}

Result<std::vector<Face>> find_faces(const TriangleMesh& mesh, double size) {
  std::vector<Face> faces;
  for (const auto& [area, index] : rank_by_area(mesh)) {
    const auto corners = mesh.corners(index);
    if (!(2.0 * area > kLowest * size * longest_edge(corners))) continue;
    const auto& [a, b, c] = corners;
    const Vec3 normal = normalized(cross(b - a, c - a));
    const bool is_known = std::any_of(faces.begin(), faces.end(), [&](const Face& face) {
      if (dot(face.normal, normal) < kCoplanarCosine) return false;
      return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
        return std::abs(dot(face.normal, corner) - face.offset) <= kCoplanarTo * size;
      });
    });
    if (is_known) continue;
    if (faces.size() == ConvexField::kMostFaces) return too_many_faces(mesh);
    faces.push_back({normal, dot(normal, a), index});
  }
  return faces;
}

/// Moves the planes out to hold all vertices; an error where that is too far.
Result<std::monostate> enclose(const TriangleMesh& mesh, double size, std::vector<Face>& faces) {
  double worst = 0.0;
  double thinnest = size;
  Vec3 worst_vertex{};
  std::size_t worst_triangle = 0;
  for (Face& face : faces) {
    double farthest = -std::numeric_limits<double>::infinity();
    double nearest = std::numeric_limits<double>::infinity();
    Vec3 vertex{};
    for (const Vec3& v : mesh.vertices()) {
      const double along = dot(face.normal, v);
      nearest = std::min(nearest, along);
      if (along > farthest) {
        farthest = along;
        vertex = v;
      }
    }
    if (farthest - face.offset > worst) {
      worst = farthest - face.offset;
      worst_vertex = vertex;
      worst_triangle = face.triangle;
    }
    face.offset = farthest;
    thinnest = std::min(thinnest, farthest - nearest);
  }
  if (faces.empty() || thinnest < kConvexTo * size) {
    return Error{
        ErrorCode::kInvalidMesh,
        format_text("mesh is too flat for a convex polyhedron: %.3g m thick (at least %.3g "
                    "m, %g of its longest side)",
                    faces.empty() ? 0.0 : thinnest, kConvexTo * size, kConvexTo)};
  }
  if (worst <= kConvexTo * size) return std::monostate{};
  return Error{
      ErrorCode::kInvalidMesh,
      format_text("mesh is not convex: vertex %s stands %.3g m out of the plane of "
                  "triangle %zu (at most %.3g m); take its hull, or build a model of it",
                  format_point(worst_vertex).c_str(), worst, worst_triangle, kConvexTo * size)};
}

}  // namespace

Result<ConvexField> ConvexField::create(const TriangleMesh& mesh, std::span<const Vec3> tangents) {
  if (auto checked = check_encloses_volume(mesh); !checked) return checked.error();
  const Bounds& bounds = mesh.bounds();
  const double size = bounds.extents()[bounds.longest_axis()];
  auto faces = find_faces(mesh, size);
  if (!faces) return faces.error();
  if (faces->size() + tangents.size() > kMostFaces) return too_many_faces(mesh);
  // enclose() moves them to where they touch.
  for (const Vec3& normal : tangents) faces->push_back({normal, kFarOut, 0});
  if (auto checked = enclose(mesh, size, *faces); !checked) return checked.error();

  ConvexField field;
  field.serial_ = next_serial();
  field.planes_.reserve(4 * faces->size());
  for (const Face& face : *faces) {
    const auto n = static_cast<Vec3f>(face.normal);
    field.planes_.insert(field.planes_.end(), {n.x, n.y, n.z, static_cast<float>(face.offset)});
  }
  for (const Vec3& v : mesh.vertices()) field.reach_ = std::max(field.reach_, length(v));
  return field;
}

float ConvexField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f ConvexField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float ConvexField::lower_bound(const Vec3f& center, float radius) const {
  return lower_bound_at(view(), center, radius);
}

simd::ConvexView ConvexField::view() const {
  return {serial_, planes_.data(), static_cast<std::int32_t>(face_count())};
}

}  // namespace voxshell
