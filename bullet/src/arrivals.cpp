#include "arrivals.h"

#include "contact_constants.h"

namespace voxshell::bullet {

Arrivals::Arrivals(const PairStep& step, bool is_of_field, double reach) {
  const auto add = [&](const Motion& a, const Motion& b, double fraction, double displacement) {
    const Pose pose = step.field_from_shell_after(fraction, a, b);
    all_[count_++] = {is_of_field ? pose.inverse() : pose,
                      static_cast<float>(displacement + reach)};
  };
  const Motion still;
  const auto farthest = [&](const Motion& a, const Motion& b) {
    return find_farthest_displacement(a, b, step.ball, step.time_step);
  };
  const Motion& a = step.motion_a;
  const Motion& b = step.motion_b;
  add(a, b, 1.0, kAddedOfDisplacement * step.farthest_displacement);
  // What touches at any time is within half of its displacement from there in the middle.
  add(a, b, 0.5, 0.5 * step.farthest_displacement);
  const double of_a = farthest(a, still);
  const double of_b = farthest(still, b);
  if (of_a > 0.0 && of_b > 0.0) {
    add(a, still, 0.5, 0.5 * of_a);
    add(still, b, 0.5, 0.5 * of_b);
  }
}

}  // namespace voxshell::bullet
