#include "voxshell/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"
#include "voxshell/distance.h"

namespace voxshell {
namespace {

/// Of the tolerance: elements that are not cleared although they move no farther than this are
/// nearer than the tolerance. Bounds fall short of distances by up to twice the motion where the
/// field is smooth, and by four times that on edges, which are looked at in parts.
constexpr double kFinestOfTolerance = 0.25;
/// Above rounding.
constexpr double kSafety = 1.000001;

/// The motion of a shell as its field sees it.
class RelativeMotion {
 public:
  RelativeMotion(const RigidMotion& world_from_field, const RigidMotion& world_from_shell,
                 const PointShell& shell)
      : field_(world_from_field), shell_(world_from_shell) {
    const Sphere& root = shell.tree().spheres(1)[0];
    center_ = static_cast<Vec3>(root.center);
    radius_ = static_cast<double>(root.radius);
    if (const EdgeSegments* edges = shell.edges(); edges != nullptr) {
      const Sphere& of_edges = edges->tree().spheres(1)[0];
      radius_ = std::max(radius_, length(static_cast<Vec3>(of_edges.center) - center_) +
                                      static_cast<double>(of_edges.radius + edges->reach()));
    }
    velocity_ = shell_.displacement - field_.displacement;
    turn_ = shell_.turn - field_.turn;
    const double bend = length(turn_) * length(shell_.turn) * length(center_);
    acceleration_ = length(cross(field_.turn, velocity_)) + bend;
  }

  Pose field_from_shell(double fraction) const {
    return field_.at(fraction).inverse() * shell_.at(fraction);
  }

  /// No element moves farther than this within `half` before or after `middle`, meters.
  double bound(double middle, double half) const {
    const double of_turn = length(turn_);
    // The velocity of the shell's origin, which changes steadily, and what others have more; or
    // that of its center.
    const double of_origin = std::max(length(velocity_of_origin(middle - half)),
                                      length(velocity_of_origin(middle + half))) +
                             of_turn * (length(center_) + radius_);
    double fastest = of_origin;
    if (of_turn > 0.0) {
      const Vec3 arm = shell_.at(middle).rotation * center_;
      const double of_center = length(velocity_of_origin(middle) + cross(turn_, arm)) +
                               half * acceleration_ + of_turn * radius_;
      fastest = std::min(fastest, of_center);
    }
    return half * kSafety * fastest;
  }

 private:
  /// As seen by the field's body, which turns.
  Vec3 velocity_of_origin(double fraction) const {
    const Vec3 apart = shell_.start.translation - field_.start.translation + fraction * velocity_;
    return velocity_ - cross(field_.turn, apart);
  }

  RigidMotion field_;
  RigidMotion shell_;
  Vec3 center_;  ///< of a ball around the elements, the shell's frame
  double radius_ = 0.0;
  Vec3 velocity_;              ///< of the shell's origin relative to the field's
  Vec3 turn_;                  ///< likewise
  double acceleration_ = 0.0;  ///< no larger for the shell's center
};

/// Whether elements touch within short motions.
template <class F, class V>
class Clearing {
 public:
  Clearing(const F& field, const V& view, const PointShell& shell, float margin,
           QueryScratch::State& state)
      : field_(field), view_(view), shell_(shell), margin_(margin), state_(state) {}

  /// Whether no element comes below the margin while each moves by up to `motion` from where it is
  /// at a pose. May deny it for what comes near.
  bool is_clear(const Pose& field_from_shell, double motion) {
    const auto posed = make_posed(field_, view_, shell_, field_from_shell);
    // Poses within the motion are rounded, too.
    const float growth = static_cast<float>(motion * kSafety) + posed.slack;
    const simd::TreeView tree = view_tree(shell_);
    const bool are_points_clear =
        is_tree_clear(posed, tree, growth, state_, [&](const simd::PointList& points) {
          return kernels_.may_come_below(posed, points, margin_, growth);
        });
    if (!are_points_clear || shell_.edges() == nullptr) return are_points_clear;
    const simd::EdgeView edges = shell_.edges()->view();
    return is_tree_clear(posed, edges.tree, growth + edges.reach, state_.of_edges(),
                         [&](const simd::PointList& pieces) {
                           return kernels_.may_edges_come_below(posed, edges, pieces, margin_,
                                                                growth);
                         });
  }

 private:
  template <class Posed, class MayComeBelow>
  bool is_tree_clear(const Posed& posed, const simd::TreeView& tree, float growth,
                     QueryScratch::State& state, const MayComeBelow& may_come_below) {
    // Spheres that are small against the motion would not tell more. Of the first, none has been
    // looked at yet.
    const auto go_on = [&](const simd::Seeds& left) {
      return left.level <= 1 || radius_at(tree, left.level) > kSmallOfMotion * growth;
    };
    const simd::Seeds left =
        walk_down(posed, tree, margin_, growth, SphereBounds::kUnwanted, state, go_on);
    if (left.nodes.count == 0) return true;
    if (left.level < tree.level_count) return false;
    simd::PointList points = state.empty_survivors();
    kernels_.sift(posed, tree, left.nodes, margin_, growth, points);
    return !may_come_below(points);
  }

  /// About that of the spheres of a level of the walk: of a surface, each has half of the area of
  /// its parent in the binary tree.
  float radius_at(const simd::TreeView& tree, int level) const {
    const int depth = tree.depth - 3 * (tree.level_count - 1 - level);
    return std::sqrt(std::ldexp(1.0f, -depth)) * shell_.tree().spheres(1)[0].radius;
  }

  static constexpr float kSmallOfMotion = 0.25f;

  const F& field_;
  const V& view_;
  const PointShell& shell_;
  const float margin_;
  QueryScratch::State& state_;
  const simd::QueryKernels<V>& kernels_ = simd::query_kernels<V>(simd::active_isa());
};

}  // namespace

Sweep sweep(const Field& field, const PointShell& shell, const RigidMotion& world_from_field,
            const RigidMotion& world_from_shell, const SweepOptions& options,
            QueryScratch& scratch) {
  const RelativeMotion motion(world_from_field, world_from_shell, shell);
  QueryScratch::State& state = scratch.state();
  state.reserve(view_tree(shell), shell.element_count() - shell.size());
  if (shell.edges() != nullptr) state.of_edges().reserve(shell.edges()->view().tree);
  const auto end_at = [&](double fraction) {
    return Sweep{fraction, find_nearest(field, shell, motion.field_from_shell(fraction),
                                        std::numeric_limits<float>::infinity(), scratch)};
  };
  if (collides(field, shell, motion.field_from_shell(0.0), options.margin)) return end_at(0.0);
  double reached = 0.0;
  const bool touches = with_view(field, [&]<class F, class V>(const F& typed, const V& view) {
    Clearing<F, V> clearing(typed, view, shell, options.margin, state);
    double step = options.end;
    bool was_clear = true;
    while (reached < options.end) {
      const double next = std::min(reached + step, options.end);
      const double half = 0.5 * (next - reached);
      const double middle = reached + half;
      const double farthest = motion.bound(middle, half);
      const bool is_clear = clearing.is_clear(motion.field_from_shell(middle), farthest);
      // Nor can numbers tell shorter steps apart.
      const bool is_finest = !(farthest > kFinestOfTolerance * options.tolerance) ||
                             !(middle > reached && middle < next);
      if (!is_clear && is_finest) return true;
      if (!is_clear) {
        step = half;
      } else {
        reached = next;
        // A step that has just been too long would be so again.
        if (was_clear) step *= 2.0;
      }
      was_clear = is_clear;
    }
    return false;
  });
  return touches ? end_at(reached) : Sweep{options.end, std::nullopt};
}

}  // namespace voxshell
