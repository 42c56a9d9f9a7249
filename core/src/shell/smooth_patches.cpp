#include "shell/smooth_patches.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/portable_math.h"
#include "mesh/box_finder.h"
#include "mesh/closest_point.h"
#include "mesh/disjoint_sets.h"
#include "mesh/edges.h"
#include "voxshell/parallel.h"
#include "voxshell/smooth_surface.h"

namespace voxshell {
namespace {

/// The cosine of kMostBend.
constexpr double kLeastCosine = 0.9781350224158666;
static_assert(SmoothSurface::kMostBend == 0.2095);

/// Corner normals within this of the face's leave a patch flat; radians.
constexpr float kFlatBend = 1e-4f;
/// Relative to the mesh's size: elements are float32.
constexpr double kRounding = 1e-6;
/// Elements whose triangles one thread finds: some milliseconds of work. Smaller models take none.
constexpr std::size_t kElementsPerTask = 8192;

std::vector<Vec3> find_face_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.triangles().size());
  for (std::uint32_t triangle = 0; triangle < normals.size(); ++triangle) {
    normals[triangle] = face_normal(mesh.corners(triangle));
  }
  return normals;
}

/// Fills `neighbors` across the edges that are no creases.
void connect(const TriangleMesh& mesh, std::span<const Vec3> face_normals, SmoothPatches& patches) {
  const auto triangles = mesh.triangles();
  const auto across_from = [&](std::uint32_t triangle, const MeshEdge& edge) {
    std::size_t corner = 0;
    while (triangles[triangle][corner] == edge.low || triangles[triangle][corner] == edge.high) {
      ++corner;
    }
    return corner;
  };
  patches.neighbors.assign(triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  for (const MeshEdge& edge : find_edges(mesh)) {
    if (edge.second == kNoTriangle) continue;
    if (!(dot(face_normals[edge.first], face_normals[edge.second]) >= kLeastCosine)) continue;
    patches.neighbors[edge.first][across_from(edge.first, edge)] = edge.second;
    patches.neighbors[edge.second][across_from(edge.second, edge)] = edge.first;
  }
}

/// Of each triangle: the area of the flat face that it is part of, m2.
std::vector<double> measure_faces(const TriangleMesh& mesh, std::span<const Vec3> face_normals,
                                  const SmoothPatches& patches) {
  const auto& neighbors = patches.neighbors;
  DisjointSets faces(neighbors.size());
  for (std::uint32_t triangle = 0; triangle < neighbors.size(); ++triangle) {
    for (const std::uint32_t other : neighbors[triangle]) {
      if (other == kNoTriangle || other < triangle) continue;
      const Vec3 bend = face_normals[other] - face_normals[triangle];
      if (squared_length(bend) <= static_cast<double>(kFlatBend * kFlatBend)) {
        faces.join(triangle, other);
      }
    }
  }
  std::vector<double> areas(neighbors.size(), 0.0);
  for (std::uint32_t triangle = 0; triangle < neighbors.size(); ++triangle) {
    const std::array<Vec3, 3> corners = mesh.corners(triangle);
    areas[faces.find(triangle)] +=
        0.5 * length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  }
  for (std::uint32_t triangle = 0; triangle < neighbors.size(); ++triangle) {
    areas[triangle] = areas[faces.find(triangle)];
  }
  return areas;
}

/// One normal for all corners at a vertex that are connected without a crease. Faces count by their
/// angle there times their squared area: a flat face beside a fillet stays flat, and the fillet
/// leaves it smoothly.
void average_normals(const TriangleMesh& mesh, std::span<const Vec3> face_normals,
                     SmoothPatches& patches) {
  const std::vector<double> face_areas = measure_faces(mesh, face_normals, patches);
  const auto triangles = mesh.triangles();
  auto& corner_normals = patches.corner_normals;
  corner_normals.assign(triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      if (corner_normals[first][corner] != kNoTriangle) continue;
      const std::uint32_t vertex = triangles[first][corner];
      const auto index = static_cast<std::uint32_t>(patches.normals.size());
      Vec3 sum;
      waiting.assign(1, first);
      while (!waiting.empty()) {
        const std::uint32_t triangle = waiting.back();
        waiting.pop_back();
        const auto& of = triangles[triangle];
        const auto at = static_cast<std::size_t>(std::ranges::find(of, vertex) - of.begin());
        if (at == kCorners || corner_normals[triangle][at] != kNoTriangle) continue;
        corner_normals[triangle][at] = index;
        const std::array<Vec3, 3> corners = mesh.corners(triangle);
        const Vec3 u = corners[next_corner(at)] - corners[at];
        const Vec3 v = corners[previous_corner(at)] - corners[at];
        const double area = face_areas[triangle];
        sum +=
            portable_atan2(length(cross(u, v)), dot(u, v)) * area * area * face_normals[triangle];
        for (const std::size_t side : {next_corner(at), previous_corner(at)}) {
          const std::uint32_t neighbor = patches.neighbors[triangle][side];
          if (neighbor != kNoTriangle) waiting.push_back(neighbor);
        }
      }
      patches.normals.push_back(static_cast<Vec3f>(normalized(sum)));
    }
  }
}

/// At the tip of a cone, where the mean is far from each of its faces, these keep their own.
void sharpen_tips(std::span<const Vec3> face_normals, SmoothPatches& patches) {
  const auto least_cosine = static_cast<float>(kLeastCosine);
  for (std::uint32_t triangle = 0; triangle < patches.corner_normals.size(); ++triangle) {
    const auto face = static_cast<Vec3f>(face_normals[triangle]);
    for (std::uint32_t& normal : patches.corner_normals[triangle]) {
      if (dot(patches.normals[normal], face) >= least_cosine) continue;
      normal = static_cast<std::uint32_t>(patches.normals.size());
      patches.normals.push_back(face);
    }
  }
}

/// Patches are farthest from their triangles at the middles of their sides or at their own.
void measure_lifts(const TriangleMesh& mesh, std::span<const Vec3> face_normals,
                   SmoothPatches& patches) {
  constexpr double kThird = 1.0 / 3.0;
  constexpr std::array<std::array<double, 3>, 4> kMiddles{
      {{0.5, 0.5, 0.0}, {0.0, 0.5, 0.5}, {0.5, 0.0, 0.5}, {kThird, kThird, kThird}}};
  patches.lifts.resize(mesh.triangles().size());
  for (std::uint32_t triangle = 0; triangle < patches.lifts.size(); ++triangle) {
    const auto face = static_cast<Vec3f>(face_normals[triangle]);
    const auto bends = [&](std::uint32_t normal) {
      return squared_length(patches.normals[normal] - face) > kFlatBend * kFlatBend;
    };
    if (std::ranges::none_of(patches.corner_normals[triangle], bends)) continue;
    const std::array<Vec3, 3> corners = mesh.corners(triangle);
    const std::array<Vec3, 3> normals = patches.normals_of(triangle);
    float& lift = patches.lifts[triangle];
    for (const std::array<double, 3>& weights : kMiddles) {
      const Vec3 lifted = position_on(corners, normals, weights) - weighted_sum(weights, corners);
      lift = std::max(lift, static_cast<float>(length(lifted)));
    }
    patches.most_lift = std::max(patches.most_lift, lift);
  }
}

/// Triangles on which a place lies.
struct Beside {
  std::uint32_t flat = kNoTriangle;
  std::uint32_t curved = kNoTriangle;
};

/// The first triangles within a distance of a place whose patches are flat, and are not.
Beside find_beside(const TriangleMesh& mesh, const SmoothPatches& patches, const BoxFinder& boxes,
                   const Vec3& place, double distance) {
  Bounds box;
  box.extend(place);
  Beside beside;
  boxes.visit(widen(box, distance), [&](std::uint32_t triangle) {
    std::uint32_t& first = patches.is_flat(triangle) ? beside.flat : beside.curved;
    if (triangle > first) return;
    const Vec3 closest = closest_point_on_triangle(place, mesh.corners(triangle));
    if (squared_length(place - closest) <= distance * distance) first = triangle;
  });
  return beside;
}

Vec3 place_of(const PointShell& shell, std::uint32_t element) {
  if (shell.is_point(element)) return static_cast<Vec3>(shell.points()[element]);
  return static_cast<Vec3>(
      shell.edges()->middles()[element - static_cast<std::uint32_t>(shell.size())]);
}

void find_elements(const TriangleMesh& mesh, const PointShell& shell, const TriangleFinder& finder,
                   SmoothPatches& patches) {
  const BoxFinder boxes(bound_triangles(mesh));
  const Vec3 size = mesh.bounds().extents();
  const double rounding = kRounding * std::max({size.x, size.y, size.z});
  const std::size_t count = shell.element_count();
  patches.triangle_of_element.resize(count);
  patches.flat_of_element.resize(count);
  const auto find = [&](std::size_t begin, std::size_t end) {
    for (std::size_t id = begin; id < end; ++id) {
      const Vec3 place = place_of(shell, static_cast<std::uint32_t>(id));
      Beside beside = find_beside(mesh, patches, boxes, place, rounding);
      if (beside.flat == kNoTriangle && beside.curved == kNoTriangle) {
        beside.flat = finder.find_nearest(place, 0);
      }
      patches.flat_of_element[id] = beside.flat;
      patches.triangle_of_element[id] = beside.curved != kNoTriangle ? beside.curved : beside.flat;
    }
  };
  parallel_for_ranges(count, kElementsPerTask, 0, {}, {}, find);
}

}  // namespace

SmoothPatches build_smooth_patches(const TriangleMesh& mesh, const PointShell& shell,
                                   const TriangleFinder& finder) {
  const std::vector<Vec3> face_normals = find_face_normals(mesh);
  SmoothPatches patches;
  connect(mesh, face_normals, patches);
  average_normals(mesh, face_normals, patches);
  sharpen_tips(face_normals, patches);
  measure_lifts(mesh, face_normals, patches);
  if (patches.most_lift > 0.0f) find_elements(mesh, shell, finder, patches);
  return patches;
}

}  // namespace voxshell
