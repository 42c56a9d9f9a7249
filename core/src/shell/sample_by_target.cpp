#include "shell/sample_by_target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/portable_math.h"
#include "base/text.h"
#include "shell/sample_on_grid.h"
#include "shell/surface_voxels.h"

namespace voxshell {
namespace {

/// A grid that shares no symmetry with the mesh; another for each index. Rotation and shift are
/// multiples of powers of the root of x^4 = x + 1, which spread evenly.
VoxelGrid make_odd_grid(double spacing, int index) {
  const auto spread = [n = index + 1.0](double step) { return n * step - std::floor(n * step); };
  const Vec3 shift{spread(0.8191725133961645), spread(0.6710436067037893),
                   spread(0.5497004779019703)};
  // From the quaternion (1, v): the last bits of sines and cosines differ by machine.
  const Vec3 v = 2.0 * shift - Vec3{1.0, 1.0, 1.0};
  const double s = 2.0 / (1.0 + squared_length(v));
  return {spacing,
          {{1.0 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y - v.z), s * (v.x * v.z + v.y)},
           {s * (v.x * v.y + v.z), 1.0 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z - v.x)},
           {s * (v.x * v.z - v.y), s * (v.y * v.z + v.x), 1.0 - s * (v.x * v.x + v.y * v.y)}},
          shift};
}

/// Finds the spacing that gives a wanted number of points. The number falls with the spacing, on
/// most meshes almost as its inverse square; but on regular ones in steps, as many voxels appear at
/// once. Where a search ends at such a step, it goes on with odd grids.
class TargetSearch {
 public:
  TargetSearch(const TriangleMesh& mesh, std::size_t target)
      : wanted_(static_cast<double>(target)) {
    const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
    grid_.spacing = std::max(std::sqrt(compute_passed_area(mesh, {}) / wanted_), longest / wanted_);
  }

  const VoxelGrid& grid() const { return grid_; }

  /// Chooses the next grid to try from the count that this one gave, which is not the one wanted.
  void take(std::size_t count) {
    const double ratio = static_cast<double>(count) / wanted_;
    if (odd_grids_ > 0) {
      grid_ = make_odd_grid(grid_.spacing * std::sqrt(std::sqrt(ratio)), odd_grids_++);
      return;
    }
    ++trials_;
    (ratio > 1.0 ? too_fine_ : too_coarse_) = {grid_.spacing, portable_log(ratio)};
    if (too_fine_.spacing == 0.0 || too_coarse_.spacing == 0.0) {
      // Beyond what is expected, if that fell short: to have it between two spacings soon.
      const double beyond = trials_ == 1 ? 0.0 : ratio > 1.0 ? 0.01 : -0.01;
      grid_.spacing *= std::max(0.5, std::sqrt(ratio)) * (1.0 + beyond);
      return;
    }
    const double apart = portable_log(too_coarse_.spacing / too_fine_.spacing);
    // By a straight line in logarithms, and by halves where that does not get there.
    const double fraction =
        trials_ % 2 == 0 ? too_fine_.log_ratio / (too_fine_.log_ratio - too_coarse_.log_ratio)
                         : 0.5;
    grid_.spacing = too_fine_.spacing * portable_exp(fraction * apart);
    constexpr double kStepWidth = 1e-4;
    constexpr int kManyTrials = 10;
    if (apart < kStepWidth || trials_ >= kManyTrials) {
      grid_ = make_odd_grid(grid_.spacing, odd_grids_++);
    }
  }

 private:
  struct Trial {
    double spacing = 0.0;
    double log_ratio = 0.0;  ///< of the count to the one wanted
  };

  double wanted_;
  VoxelGrid grid_{};
  Trial too_fine_;
  Trial too_coarse_;
  int trials_ = 0;
  int odd_grids_ = 0;
};

}  // namespace

Result<ShellSamples> sample_by_target(const TriangleMesh& mesh, std::size_t target,
                                      unsigned threads, Stage& stage) {
  constexpr int kMaxTrials = 256;  // few points must be hit to the point, and take little time
  constexpr double kTolerance = 0.01;
  const auto wanted = static_cast<double>(target);
  const auto miss = [&](const ShellSamples& sampling) {
    return std::abs(static_cast<double>(sampling.points.size()) - wanted);
  };
  TargetSearch search(mesh, target);
  ShellSamples best;
  double done = 0.0;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    // Most searches end soon: each trial counts half of what is left.
    stage.set_part(done, 0.5 * (1.0 + done));
    done = 0.5 * (1.0 + done);
    ShellSamples sampling = sample_on_grid(mesh, search.grid(), threads, stage);
    if (stage.stopped()) return make_stopped_error();
    const std::size_t count = sampling.points.size();
    const std::size_t samples = sampling.samples_taken;
    if (best.points.empty() || miss(sampling) < miss(best)) best = std::move(sampling);
    // Soon, a third trial gets as near as a quarter of the tolerance.
    const double good_enough = trial < 3 ? 0.25 * kTolerance : kTolerance;
    if (miss(best) <= good_enough * wanted) return best;

    // Finer voxels would only give more points that float32 cannot tell apart.
    constexpr std::size_t kMostSamplesAPoint = 4;
    if (count < target && samples > kMostSamplesAPoint * target) break;
    search.take(count);
  }
  return Error{ErrorCode::kInvalidArgument,
               format_text("no voxel size gives %zu points within 1 %% on this mesh; the nearest "
                           "count found is %zu: ask for that, or for a spacing",
                           target, best.points.size())};
}

}  // namespace voxshell
