#include "shell/enclosing_sphere.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace voxshell {
namespace {

struct Ball {
  Vec3 centre{};
  double squared_radius = -1.0;  ///< negative: encloses nothing

  bool encloses(const Vec3& p) const {
    constexpr double kTolerance = 1e-12;
    return squared_length(p - centre) <= squared_radius * (1.0 + kTolerance);
  }
};

/// The smallest ball with up to four points on its boundary. Points that add no new direction (a
/// coincident, collinear or coplanar one) leave it as it is without them.
class Boundary {
 public:
  Ball ball() const { return ball_; }
  bool is_full() const { return count_ == 4; }

  bool push(const Vec3& p) {
    if (count_ == 0) {
      origin_ = p;
      ball_ = {p, 0.0};
      count_ = 1;
      return true;
    }
    // Orthonormal directions spanned so far; the centre moves along the new one only.
    const Vec3 q = p - origin_;
    Vec3 across = q;
    for (int i = 0; i + 1 < count_; ++i) across = across - dot(across, axes_[i]) * axes_[i];
    const double height = length(across);
    constexpr double kFlat = 1e-9;
    if (height <= kFlat * length(q)) return false;
    const Vec3 axis = across / height;
    const Vec3 c = ball_.centre - origin_;
    const double excess = squared_length(q - c) - ball_.squared_radius;
    const double along = excess / (2.0 * height);
    ball_.centre += along * axis;
    ball_.squared_radius += along * along;
    axes_[count_ - 1] = axis;
    ++count_;
    return true;
  }

 private:
  Vec3 origin_{};
  Vec3 axes_[3]{};
  int count_ = 0;
  Ball ball_;
};

/// The smallest ball around points[0, end) that has `boundary` on its boundary.
Ball enclose(std::vector<Vec3>& points, std::size_t end, const Boundary& boundary) {
  Ball ball = boundary.ball();
  if (boundary.is_full()) return ball;
  for (std::size_t i = 0; i < end; ++i) {
    const Vec3 p = points[i];
    if (ball.encloses(p)) continue;
    Boundary with_point = boundary;
    if (!with_point.push(p)) continue;
    ball = enclose(points, i, with_point);
    std::move_backward(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(i),
                       points.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    points[0] = p;
  }
  return ball;
}

/// Takes in the farthest point outside until there is none (Gaertner 1999). A handful of passes
/// does whatever the order of the points, where Welzl's algorithm alone wants it random.
Ball enclose_all(std::span<const Vec3> points) {
  std::vector<Vec3> taken;
  Ball ball;
  while (true) {
    const Vec3* farthest = nullptr;
    double squared_distance = -1.0;
    for (const Vec3& p : points) {
      const double squared = squared_length(p - ball.centre);
      if (squared > squared_distance) {
        squared_distance = squared;
        farthest = &p;
      }
    }
    if (farthest == nullptr || ball.encloses(*farthest)) return ball;
    taken.insert(taken.begin(), *farthest);
    const Ball larger = enclose(taken, taken.size(), {});
    // Only rounding can keep a ball from growing.
    if (!(larger.squared_radius > ball.squared_radius)) return ball;
    ball = larger;
  }
}

}  // namespace

Sphere compute_enclosing_sphere(std::span<const Vec3f> points, std::span<const std::uint32_t> ids) {
  std::vector<Vec3> selected;
  selected.reserve(ids.size());
  for (const std::uint32_t id : ids) selected.push_back(static_cast<Vec3>(points[id]));
  const Ball ball = enclose_all(selected);

  const auto centre = static_cast<Vec3f>(ball.centre);
  double squared_radius = 0.0;
  for (const Vec3& p : selected) {
    squared_radius = std::max(squared_radius, squared_length(p - static_cast<Vec3>(centre)));
  }
  const auto radius = static_cast<float>(std::sqrt(squared_radius));
  return {centre, std::nextafter(radius, std::numeric_limits<float>::infinity())};
}

}  // namespace voxshell
