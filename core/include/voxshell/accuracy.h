#pragma once

#include <cstddef>

namespace voxshell {

/// Median, 99th percentile and worst of the absolute errors at many places.
struct ErrorStatistic {
  double median = 0.0;
  double p99 = 0.0;
  double worst = 0.0;
};

/// Accuracy of a model, measured at places of its surface when it is built: on faces, edges and
/// vertices. It is a statistic, not a proof.
struct Accuracy {
  std::size_t places = 0;  ///< number of measured places
  /// Error of the field's distance, which is 0 on the surface; meters.
  ErrorStatistic distance;
  /// Error of the field's gradient just inside the surface: its angle to the cone of the normals of
  /// the nearest faces; radians. pi if the gradient is 0.
  ErrorStatistic normal;
  /// Depth in a flat body that the shell does not see: how far places of the surface stand out,
  /// along the surface's normal there, above the nearest elements of the shell (points and edge
  /// segments) that do not face away; meters. At edges and corners the normal is the mean of the
  /// adjacent ones.
  ErrorStatistic coverage;
  /// Largest distance of a measured place from an element of the shell that does not face away from
  /// it; meters. Features of another body that are narrower than this may enter between elements of
  /// the shell.
  double gap = 0.0;
  /// True if faces meet at a convex edge by more than 20 degrees; no ball can roll there.
  bool is_sharp = false;
  /// Largest convex curvature elsewhere, from the angles between faces; 1/meters.
  double curvature = 0.0;
};

}  // namespace voxshell
