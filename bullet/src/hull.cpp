#include "hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>

#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <LinearMath/btConvexHullComputer.h>

#include "voxshell/bullet/convert.h"
#include "voxshell/mass_properties.h"

namespace voxshell::bullet {
namespace {

/// Between planes that meet at an edge.
constexpr double kLargestTurn = std::numbers::pi / 3.0;

/// Evenly all around, 14 degrees apart: the points of a spiral, a golden section of a turn each.
const std::array<Vec3, 200>& directions() {
  static const auto all = [] {
    std::array<Vec3, 200> made;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const auto step = static_cast<double>(i);
      const double z = 1.0 - (2.0 * step + 1.0) / static_cast<double>(made.size());
      const double angle = 2.0 * std::numbers::pi * step / std::numbers::phi;
      const double across = std::sqrt(1.0 - z * z);
      made[i] = {across * std::cos(angle), across * std::sin(angle), z};
    }
    return made;
  }();
  return all;
}

struct PointCollector : btInternalTriangleIndexCallback {
  void internalProcessTriangleIndex(btVector3* corners, int, int) override {
    for (int i = 0; i < 3; ++i) points.push_back(from_bullet(corners[i]));
  }
  std::vector<Vec3> points;
};

/// Bullet's hull, with what voxshell asks of it.
class Polyhedron {
 public:
  explicit Polyhedron(const std::vector<Vec3>& points) {
    computer_.compute(&points[0].x, sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
    for (int i = 0; i < computer_.vertices.size(); ++i) {
      vertices_.push_back(from_bullet(computer_.vertices[i]));
    }
    face_of_edge_.resize(static_cast<std::size_t>(computer_.edges.size()));
    for (int i = 0; i < computer_.faces.size(); ++i) add_face(computer_.edges[computer_.faces[i]]);
  }

  std::size_t face_count() const { return normals_.size(); }
  Result<TriangleMesh> mesh() const { return TriangleMesh::create(vertices_, triangles_); }

  /// Normals of planes that touch edges and vertices, so that some plane there is near to any
  /// direction that is between those of the faces.
  std::vector<Vec3> tangents() const {
    std::vector<Vec3> tangents;
    std::vector<std::vector<Vec3>> touching(vertices_.size());  // normals of planes, by vertex
    std::vector<Vec3> mean(vertices_.size());
    for (int i = 0; i < computer_.edges.size(); ++i) {
      const Edge& edge = computer_.edges[i];
      const auto from = static_cast<std::size_t>(edge.getSourceVertex());
      const auto to = static_cast<std::size_t>(edge.getTargetVertex());
      const Vec3& left = normal_at(edge);
      touching[from].push_back(left);
      mean[from] += left;
      if (from > to) continue;
      const Vec3& right = normal_at(*edge.getReverseEdge());
      const double turn = std::acos(std::clamp(dot(left, right), -1.0, 1.0));
      const int parts = static_cast<int>(std::ceil(turn / kLargestTurn));
      for (int part = 1; part < parts; ++part) {
        const double angle = turn * part / parts;
        const Vec3 between = normalized(std::sin(turn - angle) * left + std::sin(angle) * right);
        tangents.push_back(between);
        touching[from].push_back(between);
        touching[to].push_back(between);
      }
    }
    const double near_cosine = std::cos(0.5 * kLargestTurn);
    const auto add_at = [&](std::size_t vertex, const Vec3& normal) {
      const auto is_near = [&](const Vec3& other) { return dot(normal, other) > near_cosine; };
      if (std::ranges::any_of(touching[vertex], is_near)) return;
      tangents.push_back(normal);
      touching[vertex].push_back(normal);
    };
    for (std::size_t i = 0; i < vertices_.size(); ++i) add_at(i, normalized(mean[i]));
    for (const Vec3& direction : directions()) add_at(find_farthest(direction), direction);
    return tangents;
  }

 private:
  using Edge = btConvexHullComputer::Edge;

  std::size_t index_of(const Edge& edge) const {
    return static_cast<std::size_t>(&edge - &computer_.edges[0]);
  }
  std::size_t find_farthest(const Vec3& direction) const {
    std::size_t farthest = 0;
    double most = dot(vertices_[0], direction);
    for (std::size_t i = 1; i < vertices_.size(); ++i) {
      const double along = dot(vertices_[i], direction);
      if (along > most) farthest = i;
      most = std::max(most, along);
    }
    return farthest;
  }
  const Vec3& normal_at(const Edge& edge) const { return normals_[face_of_edge_[index_of(edge)]]; }

  void add_face(const Edge& first) {
    const int apex = first.getSourceVertex();
    Vec3 area{};
    const Edge* edge = &first;
    do {
      face_of_edge_[index_of(*edge)] = normals_.size();
      const int from = edge->getSourceVertex();
      const int to = edge->getTargetVertex();
      if (from != apex && to != apex) {
        const Triangle triangle{static_cast<std::uint32_t>(apex), static_cast<std::uint32_t>(from),
                                static_cast<std::uint32_t>(to)};
        const auto& [a, b, c] = triangle;
        area += cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
        triangles_.push_back(triangle);
      }
      edge = edge->getNextEdgeOfFace();
    } while (edge != &first);
    normals_.push_back(normalized(area));
  }

  btConvexHullComputer computer_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Vec3> normals_;  ///< of the faces, outwards
  std::vector<std::size_t> face_of_edge_;
};

std::size_t hash_of(const std::vector<Vec3>& points) {
  return std::hash<std::string_view>{}(
      {reinterpret_cast<const char*>(points.data()), points.size() * sizeof(Vec3)});
}

}  // namespace

std::vector<Vec3> Hull::points_of(const btConvexShape& shape) {
  if (shape.getShapeType() == CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) {
    const auto& mesh = static_cast<const btConvexTriangleMeshShape&>(shape);
    PointCollector collector;
    const btVector3 all(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    mesh.getMeshInterface()->InternalProcessAllTriangles(&collector, -all, all);
    return std::move(collector.points);
  }
  const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
  std::vector<Vec3> points(static_cast<std::size_t>(polyhedron.getNumVertices()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    btVector3 point;
    polyhedron.getVertex(static_cast<int>(i), point);
    points[i] = from_bullet(point);
  }
  return points;
}

std::optional<Hull> Hull::create(std::vector<Vec3> points) {
  constexpr std::size_t kFewest = 4;
  const auto is_usable = [](const Vec3& p) { return is_finite(p); };
  if (points.size() < kFewest || !std::ranges::all_of(points, is_usable)) return std::nullopt;
  const Polyhedron polyhedron(points);
  if (polyhedron.face_count() > ConvexField::kMostFaces) return std::nullopt;
  const auto mesh = polyhedron.mesh();
  if (!mesh) return std::nullopt;
  auto field = ConvexField::create(*mesh, polyhedron.tangents());
  if (!field) return std::nullopt;
  const std::span<const Vec3> corners = mesh->vertices();
  return Hull(std::move(points), {corners.begin(), corners.end()},
              compute_solid_mass_properties(*mesh).center_of_mass, *std::move(field));
}

Hull::Hull(std::vector<Vec3> points, std::vector<Vec3> corners, const Vec3& middle, Field field)
    : points_(std::move(points)),
      corners_(std::move(corners)),
      middle_(middle),
      field_(std::move(field)) {}

bool Hull::is_of(const btConvexShape& shape) const {
  // Of its mesh, Bullet's shape cannot say what has changed.
  if (shape.getShapeType() == CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) return true;
  const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
  if (static_cast<std::size_t>(polyhedron.getNumVertices()) != points_.size()) return false;
  btVector3 last;
  polyhedron.getVertex(polyhedron.getNumVertices() - 1, last);
  return from_bullet(last) == points_.back();
}

std::shared_ptr<const Hull> Hulls::of(const btConvexShape& shape) {
  std::vector<Vec3> points = Hull::points_of(shape);
  const std::size_t hash = hash_of(points);
  const std::lock_guard lock(mutex_);
  const auto found = by_hash_.find(hash);
  if (found != by_hash_.end() && found->second.points == points) return found->second.hull;
  if (by_hash_.size() >= most_) {
    std::erase_if(by_hash_, [](const auto& entry) { return entry.second.hull.use_count() <= 1; });
    most_ = std::max(kFew, 2 * by_hash_.size());
  }
  std::shared_ptr<const Hull> hull;
  if (auto made = Hull::create(points)) hull = std::make_shared<const Hull>(*std::move(made));
  by_hash_.insert_or_assign(hash, Kept{std::move(points), hull});
  return hull;
}

}  // namespace voxshell::bullet
