#pragma once

#include <cstddef>

namespace voxshell {

/// Median, 99th percentile and worst of the absolute errors at many places.
struct ErrorStatistic {
  double median = 0.0;
  double p99 = 0.0;
  double worst = 0.0;
};

/// How exact a model is, measured on places of its surface when it is built: on faces, edges and
/// vertices. A statistic, not a proof.
struct Accuracy {
  std::size_t places = 0;  ///< at which it was measured
  /// Of the field's distance, which is 0 on the surface; metres.
  ErrorStatistic distance;
  /// Of the field's gradient just inside of the surface: its angle to the cone of the normals of
  /// the nearest faces; radians. pi where the gradient is 0.
  ErrorStatistic normal;
  /// How far places of the surface stand out, along the surface's normal there, above the shell's
  /// elements (points and edge segments) that are nearest to them and do not face away: the depth
  /// in a flat body that the shell does not see; metres. At edges and corners the normal is the
  /// mean of those around.
  ErrorStatistic coverage;
  /// No place of the surface that was looked at is farther than this from an element of the shell
  /// that does not face away from it; metres. What is sharper than the shell is dense may enter
  /// between its elements.
  double gap = 0.0;
  /// Whether faces meet at a convex edge by more than 20 degrees, where no ball can roll.
  bool is_sharp = false;
  /// Largest convex curvature elsewhere, from the angles between faces; 1/metres.
  double curvature = 0.0;
};

}  // namespace voxshell
