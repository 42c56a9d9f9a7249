#include "voxshell/smooth_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "mesh/closest_point.h"
#include "mesh/edges.h"
#include "mesh/triangle_finder.h"
#include "shell/smooth_patches.h"

namespace voxshell {
namespace {

/// Most triangles that a slide leads through: half a turn of a fine mesh.
constexpr int kMostTriangles = 256;
/// Most triangles that a walk to a nearest place leads through: farther away, the tree is faster.
constexpr int kMostWalked = 8;
/// Triangles that a slide crosses without moving before it counts as at rest on a vertex.
constexpr int kMostAround = 8;
/// Most times that a point is moved along a normal toward the surface to find what is nearest.
constexpr int kMostProjections = 6;
/// It has come near enough if it moves by less than this fraction of its coordinates.
constexpr double kProjected = 1e-5;
/// A vector of a triangle's plane.
struct Planar {
  double x;
  double y;

  friend double dot(const Planar& a, const Planar& b) { return a.x * b.x + a.y * b.y; }
  friend Planar operator*(double s, const Planar& a) { return {s * a.x, s * a.y}; }
  friend Planar operator+(const Planar& a, const Planar& b) { return {a.x + b.x, a.y + b.y}; }
};

/// The slope and the second derivatives of an objective at a place.
struct Shape {
  Planar slope;
  double xx;
  double xy;
  double yy;

  double along(const Planar& d) const {
    return d.x * d.x * xx + 2.0 * d.x * d.y * xy + d.y * d.y * yy;
  }
};

/// Where a straight way leaves a triangle; kCorners: nowhere.
struct Exit {
  double fraction;
  std::size_t side;
};

/// Of a place by its weights, and the change of these along the way.
Exit find_exit(const std::array<double, 3>& weights, const std::array<double, 3>& way) {
  Exit exit{1.0, kCorners};
  for (std::size_t corner = 0; corner < kCorners; ++corner) {
    if (!(way[corner] < 0.0)) continue;
    const double fraction = weights[corner] / -way[corner];
    if (fraction < exit.fraction) exit = {fraction, corner};
  }
  return exit;
}

void move(std::array<double, 3>& weights, const std::array<double, 3>& way, double fraction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kCorners; ++i) {
    weights[i] = std::max(weights[i] + fraction * way[i], 0.0);
    sum += weights[i];
  }
  for (double& weight : weights) weight /= sum;
}

/// The step to where an objective is largest, along those of its axes along which it is concave by
/// at least `least`. None where it is convex by as much: it has no largest value around.
std::optional<Planar> newton_step(const Shape& shape, double least) {
  const double middle = 0.5 * (shape.xx + shape.yy);
  const double half = 0.5 * (shape.xx - shape.yy);
  const double apart = std::sqrt(half * half + shape.xy * shape.xy);
  if (middle + apart >= least) return std::nullopt;
  Planar axis{1.0, 0.0};
  if (apart > 0.0) {
    // Of the two ways to write the axis of the larger one, that without cancellation.
    axis = half >= 0.0 ? Planar{half + apart, shape.xy} : Planar{shape.xy, apart - half};
    axis = (1.0 / std::sqrt(dot(axis, axis))) * axis;
  }
  const Planar other{-axis.y, axis.x};
  Planar step{0.0, 0.0};
  for (const auto& [direction, curvature] :
       {std::pair{axis, middle + apart}, std::pair{other, middle - apart}}) {
    if (-curvature >= least) step = step + (-dot(shape.slope, direction) / curvature) * direction;
  }
  return step;
}

}  // namespace

/// A triangle in its own plane: the first corner is the origin, the second lies on the x axis.
struct SmoothSurface::Chart {
  std::array<Vec3, 3> corners;
  std::array<Planar, 3> planar;
  Vec3 x_axis;
  Vec3 y_axis;
  double height;  ///< of the third corner, meters; 0 without area

  /// The change of each corner's weight by a way of the plane.
  Weights weights_of(const Planar& way) const {
    const double second = (way.x - way.y * planar[2].x / height) / planar[1].x;
    const double third = way.y / height;
    return {-second - third, second, third};
  }
  /// Of each corner's weight.
  std::array<Planar, 3> gradients() const {
    const Planar third{0.0, 1.0 / height};
    const Planar second{1.0 / planar[1].x, -planar[2].x / (height * planar[1].x)};
    return {-1.0 * (second + third), second, third};
  }
};

/// How far a place of the patches is along a direction.
struct SmoothSurface::Height {
  const SmoothSurface& surface;
  Vec3 direction;
  double least_curvature;

  Shape operator()(const Chart& chart, const Place& place) const {
    const Planar slope{dot(chart.x_axis, direction), dot(chart.y_axis, direction)};
    Shape shape{slope, 0.0, 0.0, 0.0};
    if (surface.is_flat(place.triangle)) return shape;
    // The lift is a sum over pairs of corners of weight times weight times `bulge`.
    const std::array<Vec3, 3> normals = surface.patches_->normals_of(place.triangle);
    const std::array<Planar, 3> gradients = chart.gradients();
    for (std::size_t i = 0; i < kCorners; ++i) {
      const std::size_t j = next_corner(i);
      const Vec3 side = chart.corners[i] - chart.corners[j];
      const double bulge = kShapeFactor * (dot(side, normals[i]) * dot(normals[i], direction) -
                                           dot(side, normals[j]) * dot(normals[j], direction));
      const Planar& a = gradients[i];
      const Planar& b = gradients[j];
      shape.slope = shape.slope + bulge * (place.weights[j] * a + place.weights[i] * b);
      shape.xx += 2.0 * bulge * a.x * b.x;
      shape.xy += bulge * (a.x * b.y + a.y * b.x);
      shape.yy += 2.0 * bulge * a.y * b.y;
    }
    return shape;
  }

  std::optional<Weights> step(const Place& place) const {
    const Chart chart = surface.chart_of(place.triangle);
    if (!(chart.height > 0.0)) return std::nullopt;
    const std::optional<Planar> step = newton_step((*this)(chart, place), least_curvature);
    if (!step) return std::nullopt;
    return chart.weights_of(*step);
  }
  double step_along(const Place& place, std::size_t from, std::size_t to) const {
    const Chart chart = surface.chart_of(place.triangle);
    const Planar whole = chart.planar[to] + -1.0 * chart.planar[from];
    const double size = std::sqrt(dot(whole, whole));
    const Planar side = (1.0 / size) * whole;
    const Shape shape = (*this)(chart, place);
    const double curvature = shape.along(side);
    return -curvature >= least_curvature ? -dot(shape.slope, side) / (curvature * size) : 0.0;
  }
};

/// How near a place of the triangles is to a point.
struct SmoothSurface::Nearness {
  const SmoothSurface& surface;
  Vec3 point;

  std::optional<Weights> step(const Place& place) const {
    const std::array<Vec3, 3> corners = surface.mesh_->corners(place.triangle);
    const Vec3 u = corners[1] - corners[0];
    const Vec3 v = corners[2] - corners[0];
    const Vec3 way = point - weighted_sum(place.weights, corners);
    const double uu = dot(u, u);
    const double uv = dot(u, v);
    const double vv = dot(v, v);
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0.0)) return std::nullopt;
    const double along_u = dot(way, u);
    const double along_v = dot(way, v);
    const double second = (vv * along_u - uv * along_v) / determinant;
    const double third = (uu * along_v - uv * along_u) / determinant;
    return Weights{-second - third, second, third};
  }
  double step_along(const Place& place, std::size_t from, std::size_t to) const {
    const std::array<Vec3, 3> corners = surface.mesh_->corners(place.triangle);
    const Vec3 side = corners[to] - corners[from];
    return dot(point - weighted_sum(place.weights, corners), side) / squared_length(side);
  }
};

SmoothSurface::SmoothSurface(const TriangleMesh& mesh, const PointShell& shell)
    : mesh_(&mesh),
      finder_(std::make_unique<const TriangleFinder>(mesh)),
      patches_(std::make_unique<const SmoothPatches>(build_smooth_patches(mesh, shell, *finder_))) {
}

SmoothSurface::~SmoothSurface() = default;

bool SmoothSurface::is_curved() const { return patches_->most_lift > 0.0f; }

bool SmoothSurface::is_flat(std::uint32_t triangle) const { return patches_->is_flat(triangle); }

std::uint32_t SmoothSurface::triangle_of(std::uint32_t element) const {
  return patches_->triangle_of_element[element];
}

float SmoothSurface::lift(std::uint32_t triangle) const { return patches_->lifts[triangle]; }

float SmoothSurface::most_lift() const { return patches_->most_lift; }

bool SmoothSurface::lies_flat(std::uint32_t element, const Vec3& direction, double cosine) const {
  const std::uint32_t triangle = patches_->flat_of_element[element];
  return triangle != kNoTriangle && dot(face_normal(mesh_->corners(triangle)), direction) >= cosine;
}

bool SmoothSurface::is_at_crease(const Place& place) const {
  for (std::size_t side = 0; side < kCorners; ++side) {
    if (place.weights[side] == 0.0 && patches_->neighbors[place.triangle][side] == kNoTriangle)
      return true;
  }
  return false;
}

SmoothSurface::Chart SmoothSurface::chart_of(std::uint32_t triangle) const {
  Chart chart;
  chart.corners = mesh_->corners(triangle);
  const Vec3 base = chart.corners[1] - chart.corners[0];
  const Vec3 side = chart.corners[2] - chart.corners[0];
  chart.x_axis = normalized(base);
  const double along = dot(side, chart.x_axis);
  const Vec3 height = side - along * chart.x_axis;
  chart.y_axis = normalized(height);
  chart.height = length(height);
  chart.planar = {Planar{0.0, 0.0}, Planar{length(base), 0.0}, Planar{along, chart.height}};
  return chart;
}

Vec3 SmoothSurface::position(const Place& place) const {
  return position_on(mesh_->corners(place.triangle), patches_->normals_of(place.triangle),
                     place.weights);
}

Vec3 SmoothSurface::normal(const Place& place) const {
  return normalized(weighted_sum(place.weights, patches_->normals_of(place.triangle)));
}

SmoothSurface::TangentPlane SmoothSurface::tangent_plane(const Place& place) const {
  const std::array<Vec3, 3> normals = patches_->normals_of(place.triangle);
  return {position_on(mesh_->corners(place.triangle), normals, place.weights),
          normalized(weighted_sum(place.weights, normals))};
}

SmoothSurface::Place SmoothSurface::nearest_on(std::uint32_t triangle, const Vec3& point) const {
  const std::array<Vec3, 3> corners = mesh_->corners(triangle);
  const Vec3 on = closest_point_on_triangle(point, corners);
  const Vec3 area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double squared = squared_length(area);
  if (!(squared > 0.0)) return {triangle, {1.0, 0.0, 0.0}};
  const auto weight = [&](std::size_t corner) {
    const Vec3& a = corners[next_corner(corner)];
    const Vec3& b = corners[previous_corner(corner)];
    return std::clamp(dot(cross(a - on, b - on), area) / squared, 0.0, 1.0);
  };
  const double second = weight(1);
  const double third = std::min(weight(2), 1.0 - second);
  return {triangle, {1.0 - second - third, second, third}};
}

/// The same place on the triangle across from a corner.
SmoothSurface::Place SmoothSurface::across(const Place& place, std::size_t side) const {
  const std::uint32_t triangle = patches_->neighbors[place.triangle][side];
  const Triangle& from = mesh_->triangles()[place.triangle];
  const Triangle& to = mesh_->triangles()[triangle];
  Place moved{triangle, {}};
  for (std::size_t i = 0; i < kCorners; ++i) {
    for (const std::size_t shared : {next_corner(side), previous_corner(side)}) {
      if (to[i] == from[shared]) moved.weights[i] = place.weights[shared];
    }
  }
  return moved;
}

/// The part of a change of weights that leads along the side across from a corner, of its length.
double SmoothSurface::along_side(std::uint32_t triangle, const Weights& way,
                                 std::size_t side) const {
  const std::array<Vec3, 3> corners = mesh_->corners(triangle);
  const Vec3 along = corners[previous_corner(side)] - corners[next_corner(side)];
  return dot(weighted_sum(way, corners), along) / squared_length(along);
}

/// Newton's steps from triangle to triangle, on whose patches the objective is quadratic.
template <class Objective>
SmoothSurface::Slide SmoothSurface::climb(Place place, const Objective& objective,
                                          int most_triangles) const {
  std::uint32_t before = kNoTriangle;
  int standing = 0;
  for (int i = 0; i < most_triangles; ++i) {
    const std::optional<Weights> way = objective.step(place);
    if (!way) return {place, false};
    const Exit exit = find_exit(place.weights, *way);
    move(place.weights, *way, exit.fraction);
    if (exit.side == kCorners) return {place, true};
    standing = exit.fraction > 0.0 ? 0 : standing + 1;
    if (standing > kMostAround) return {place, true};
    std::size_t side = exit.side;
    const std::uint32_t neighbor = patches_->neighbors[place.triangle][side];
    if (neighbor == kNoTriangle || neighbor == before) {
      // At a crease, or where two patches lead to each other, on along the side.
      const std::size_t from = next_corner(side);
      const std::size_t to = previous_corner(side);
      const double wanted = neighbor == kNoTriangle
                                ? objective.step_along(place, from, to)
                                : (1.0 - exit.fraction) * along_side(place.triangle, *way, side);
      const double target = place.weights[to] + wanted;
      const double reached = std::clamp(target, 0.0, 1.0);
      if (reached != place.weights[to]) standing = 0;
      place.weights[side] = 0.0;
      place.weights[to] = reached;
      place.weights[from] = 1.0 - reached;
      if (reached == target) return {place, true};
      // Past the end of the side: on over the other one that ends there.
      side = reached > 0.0 ? from : to;
      if (patches_->neighbors[place.triangle][side] == kNoTriangle) return {place, false};
    }
    before = place.triangle;
    place = across(place, side);
  }
  return {place, false};
}

/// From the place of the flat triangles that is nearest to one, to that of their patches. `find`
/// finds the former, from a place on.
template <class F>
std::optional<SmoothSurface::Place> SmoothSurface::project(const Vec3& point, Place place,
                                                           const F& find) const {
  Vec3 near = point;
  for (int i = 0; i < kMostProjections; ++i) {
    const Slide found = find(near, place);
    if (!found.is_at_rest) return std::nullopt;
    place = found.place;
    if (is_flat(place.triangle)) break;
    // Seen from afar, corners of facets are nearest.
    const auto [position, out] = tangent_plane(place);
    const Vec3 moved = point - dot(point - position, out) * out;
    if (squared_length(moved - near) <= kProjected * kProjected * squared_length(point)) break;
    near = moved;
  }
  return place;
}

SmoothSurface::Place SmoothSurface::nearest(const Vec3& point, std::uint32_t guess) const {
  bool is_searched = false;
  // Once the tree has found the part of the surface, what is nearest to its patches is near by.
  const auto find = [&](const Vec3& near, const Place& place) {
    if (is_searched) {
      const Slide walked = climb(place, Nearness{*this, near}, kMostWalked);
      if (walked.is_at_rest) return walked;
    }
    is_searched = true;
    return Slide{nearest_on(finder_->find_nearest(near, place.triangle), near), true};
  };
  return project(point, {guess, {}}, find).value_or(Place{guess, {}});
}

SmoothSurface::Place SmoothSurface::below(const Place& start, const Vec3& point) const {
  return climb(start, Nearness{*this, point}, kMostTriangles).place;
}

std::optional<SmoothSurface::Place> SmoothSurface::nearest_from(const Place& start,
                                                                const Vec3& point) const {
  return project(point, start, [&](const Vec3& near, const Place& place) {
    return climb(place, Nearness{*this, near}, kMostWalked);
  });
}

SmoothSurface::Slide SmoothSurface::slide(const Place& start, const Vec3& direction,
                                          double least_curvature) const {
  return climb(start, Height{*this, direction, least_curvature}, kMostTriangles);
}

}  // namespace voxshell
