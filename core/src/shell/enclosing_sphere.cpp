#include "shell/enclosing_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace voxshell {
namespace {

struct Ball {
  Vec3 center{};
  double squared_radius = -1.0;  ///< negative: encloses nothing

  bool encloses(const Vec3& p) const {
    constexpr double kTolerance = 1e-12;
    return squared_length(p - center) <= squared_radius * (1.0 + kTolerance);
  }
};

/// The smallest ball with up to four points on its boundary. Points that add no new direction (a
/// coincident, collinear or coplanar one) leave it as it is without them.
class Boundary {
 public:
  const Ball& ball() const { return balls_[count_]; }
  bool is_full() const { return count_ == 4; }

  bool push(const Vec3& p) {
    if (count_ == 0) {
      origin_ = p;
      balls_[1] = {p, 0.0};
      count_ = 1;
      return true;
    }
    // Orthonormal directions spanned so far; the center moves along the new one only.
    const Vec3 q = p - origin_;
    Vec3 across = q;
    for (std::size_t i = 0; i + 1 < count_; ++i) across = across - dot(across, axes_[i]) * axes_[i];
    const double height = length(across);
    constexpr double kFlat = 1e-9;
    if (height <= kFlat * length(q)) return false;
    const Vec3 axis = across / height;
    const Vec3 c = ball().center - origin_;
    const double excess = squared_length(q - c) - ball().squared_radius;
    const double along = excess / (2.0 * height);
    balls_[count_ + 1] = {ball().center + along * axis, ball().squared_radius + along * along};
    axes_[count_ - 1] = axis;
    ++count_;
    return true;
  }
  void pop() { --count_; }

 private:
  Vec3 origin_{};
  std::array<Vec3, 3> axes_{};
  std::array<Ball, 5> balls_{};  ///< of no point, of one, ...
  std::size_t count_ = 0;
};

/// The few points that a ball may hang on, those that it last grew by first.
class Candidates {
 public:
  std::size_t size() const { return size_; }
  const Vec3& operator[](std::size_t i) const { return points_[i]; }

  /// Where there are too many, the last is dropped: the up to four of the ball are first.
  void insert_first(const Vec3& p) {
    size_ = std::min(size_ + 1, points_.size());
    std::copy_backward(points_.begin(), points_.begin() + size_ - 1, points_.begin() + size_);
    points_[0] = p;
  }

  void move_to_front(std::size_t i) {
    std::rotate(points_.begin(), points_.begin() + i, points_.begin() + i + 1);
  }

 private:
  std::array<Vec3, 32> points_;
  std::size_t size_ = 0;
};

/// Makes `ball` the smallest around points[0, end) that has `boundary` on its boundary.
void enclose(Candidates& points, std::size_t end, Boundary& boundary, Ball& ball) {
  ball = boundary.ball();
  if (boundary.is_full()) return;
  for (std::size_t i = 0; i < end; ++i) {
    if (ball.encloses(points[i]) || !boundary.push(points[i])) continue;
    enclose(points, i, boundary, ball);
    boundary.pop();
    points.move_to_front(i);
  }
}

/// Takes in the farthest point outside until there is none (Gaertner 1999). A handful of passes
/// does whatever the order of the points, where Welzl's algorithm alone wants it random.
Ball enclose_all(std::span<const Vec3> points) {
  Candidates taken;
  Ball ball{0.5 * (points.front() + points.back())};
  if (points.size() <= 2) return ball;
  while (true) {
    const Vec3* farthest = nullptr;
    double squared_distance = -1.0;
    for (const Vec3& p : points) {
      const double squared = squared_length(p - ball.center);
      if (squared > squared_distance) {
        squared_distance = squared;
        farthest = &p;
      }
    }
    if (farthest == nullptr || ball.encloses(*farthest)) return ball;
    taken.insert_first(*farthest);
    Boundary boundary;
    Ball larger;
    enclose(taken, taken.size(), boundary, larger);
    // Only rounding can keep a ball from growing.
    if (!(larger.squared_radius > ball.squared_radius)) return ball;
    ball = larger;
  }
}

Sphere enclose_rounded(std::span<const Vec3> points) {
  const Ball ball = enclose_all(points);
  const auto center = static_cast<Vec3f>(ball.center);
  double squared_radius = 0.0;
  for (const Vec3& p : points) {
    squared_radius = std::max(squared_radius, squared_length(p - static_cast<Vec3>(center)));
  }
  const auto radius = static_cast<float>(std::sqrt(squared_radius));
  return {center, std::nextafter(radius, std::numeric_limits<float>::infinity())};
}

}  // namespace

Sphere compute_enclosing_sphere(std::span<const Vec3f> points, std::span<const std::uint32_t> ids) {
  const auto select = [&](Vec3* selected) {
    for (const std::uint32_t id : ids) *selected++ = static_cast<Vec3>(points[id]);
  };
  // Most clusters are small, and then allocating takes longer than the rest.
  std::array<Vec3, 16> few;
  if (ids.size() <= few.size()) {
    select(few.data());
    return enclose_rounded(std::span(few).first(ids.size()));
  }
  std::vector<Vec3> many(ids.size());
  select(many.data());
  return enclose_rounded(many);
}

}  // namespace voxshell
