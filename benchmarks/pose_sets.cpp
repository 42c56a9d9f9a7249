#include "pose_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "support/random.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/plane_field.h"

namespace voxshell::benchmarks {
namespace {

using test_support::Random;

constexpr std::uint64_t kSeed = 53;

/// Of all points nearer than the range's clearance; minus infinity without any.
double compute_depth(const Field& field, const PointShell& shell, const Pose& field_from_shell,
                     DepthRange range) {
  const auto margin = static_cast<float>(std::max(0.0, -1.5 * range.low));
  double depth = -std::numeric_limits<double>::infinity();
  for (const Contact& c : find_contacts_flat(field, shell, field_from_shell, {.margin = margin})) {
    depth = std::max(depth, static_cast<double>(c.depth));
  }
  return depth;
}

/// Moves a pose along `away`, from where `measure` is above the range, until it is in the range.
/// Nothing where `measure` jumps over it.
template <class Measure>
std::optional<Pose> draw_out(Pose field_from_shell, const Vec3& away, DepthRange range,
                             const Measure& measure) {
  constexpr double kFar = 1.0;
  const Vec3 start = field_from_shell.translation;
  double near = 0.0;
  double far = kFar;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (near + far);
    field_from_shell.translation = start + middle * away;
    const double value = measure(field_from_shell);
    if (value >= range.low && value <= range.high) return field_from_shell;
    (value > range.high ? near : far) = middle;
  }
  return std::nullopt;
}

/// Asks for poses until there are `count`, or too many could not be had.
template <class MakePose>
std::vector<Pose> collect_poses(std::size_t count, const MakePose& make_pose) {
  std::vector<Pose> poses;
  for (std::size_t tries = 0; poses.size() < count && tries < 3 * count + 10; ++tries) {
    if (const std::optional<Pose> pose = make_pose()) poses.push_back(*pose);
  }
  return poses;
}

/// A narrow part of the range, so that depths fill it evenly.
DepthRange pick_depth(DepthRange range, Random& random) {
  const double width = 0.05 * (range.high - range.low);
  const double low = random.uniform(range.low, range.high - width);
  return {low, low + width};
}

Matrix3 rotation_about(const Vec3& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Vec3 a = axis;
  const Vec3 r = (1.0 - c) * a;
  return {{c + r.x * a.x, r.x * a.y - s * a.z, r.x * a.z + s * a.y},
          {r.x * a.y + s * a.z, c + r.y * a.y, r.y * a.z - s * a.x},
          {r.x * a.z - s * a.y, r.y * a.z + s * a.x, c + r.z * a.z}};
}

}  // namespace

std::vector<Pose> make_resting_poses(Bodies& bodies, std::size_t count) {
  constexpr double kTau = 6.283185307179586;
  constexpr double kMostTilt = 0.2 * kTau / 360.0;
  constexpr double kAside = 0.05;
  constexpr DepthRange kContacts{340.0, 370.0};
  const Matrix3 z_from_y_up{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  const Vec3 up{0.0, 0.0, 1.0};
  const Field plane = PlaneField{};
  const PointShell& shell = bodies.bunny().shell();
  // A little deeper than is wanted, so that a slab's other side is far away.
  const double start_height = -bodies.bunny_mesh().bounds().lower.y - 0.01;
  const auto count_contacts = [&](const Pose& pose) {
    return static_cast<double>(find_contacts_flat(plane, shell, pose).size());
  };
  Random random(kSeed);
  return collect_poses(count, [&] {
    const double heading = random.uniform(0.0, kTau);
    const Vec3 tilt_axis{std::cos(heading), std::sin(heading), 0.0};
    const Matrix3 rotation = rotation_about(tilt_axis, random.uniform(0.0, kMostTilt)) *
                             rotation_about(up, random.uniform(0.0, kTau)) * z_from_y_up;
    const Vec3 start{random.uniform(-kAside, kAside), random.uniform(-kAside, kAside),
                     start_height};
    return draw_out({rotation, start}, up, kContacts, count_contacts);
  });
}

std::vector<Pose> make_pair_poses(Bodies& bodies, const Field& bunny, const PointShell& shell,
                                  DepthRange range, DrawnFrom drawn_from, std::size_t count) {
  Random random(kSeed + 1);
  return collect_poses(count, [&] {
    const Matrix3 rotation = random.rotation();
    Vec3 start{};
    if (drawn_from == DrawnFrom::kCore) {
      const Vec3f& point = shell.points()[random.below(shell.size())];
      start = bodies.bunny_core() - rotation * static_cast<Vec3>(point);
    }
    const DepthRange depth = pick_depth(range, random);
    return draw_out({rotation, start}, random.direction(), depth,
                    [&](const Pose& pose) { return compute_depth(bunny, shell, pose, depth); });
  });
}

std::vector<Pose> make_random_poses(double reach, std::size_t count) {
  Random random(kSeed + 2);
  std::vector<Pose> poses;
  while (poses.size() < count) {
    const Matrix3 rotation = random.rotation();
    poses.push_back({rotation, reach * std::cbrt(random.unit()) * random.direction()});
  }
  return poses;
}

}  // namespace voxshell::benchmarks
