#include "model/measure_accuracy.h"

#include <cmath>

namespace voxshell {

Accuracy measure_accuracy(const TriangleMesh&, const GridField& field, const PointShell& shell,
                          unsigned) {
  Accuracy accuracy;
  const double error = field.interpolation_error();
  accuracy.distance = {error, error, error};
  accuracy.gap = std::sqrt(3.0) * shell.spacing();
  accuracy.coverage = {accuracy.gap, accuracy.gap, accuracy.gap};
  accuracy.is_sharp = true;
  return accuracy;
}

}  // namespace voxshell
