#include "mesh/closest_point.h"

#include <algorithm>

namespace voxshell {
namespace {

Vec3 closest_point_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double squared = squared_length(ab);
  return squared > 0.0 ? a + std::clamp(dot(p - a, ab) / squared, 0.0, 1.0) * ab : a;
}

}  // namespace

Vec3 closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double d1 = dot(ab, ap);
  const double d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;

  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp);
  const double d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return b;

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) {
    return a + (d1 / (d1 - d3)) * ab;
  }

  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp);
  const double d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return c;

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return a + (d2 / (d2 - d6)) * ac;
  }

  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return b + along * (c - b);
  }

  const double total = va + vb + vc;
  const Vec3 on_face = a + (vb / total) * ab + (vc / total) * ac;
  // On a needle the weights are mostly rounding (on one without area, 0 / 0), but it has no point
  // far from its sides.
  constexpr double kThin = 1e-6;  // sine of the angle at a, squared
  if (total > kThin * squared_length(ab) * squared_length(ac)) return on_face;
  Vec3 best = closest_point_on_segment(p, a, b);
  for (const Vec3& candidate :
       {closest_point_on_segment(p, b, c), closest_point_on_segment(p, c, a), on_face}) {
    if (squared_length(p - candidate) < squared_length(p - best)) best = candidate;
  }
  return best;
}

}  // namespace voxshell
