#include "deep_on_the_way.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"
#include "motion.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

bool may_be_deep_on_the_way(const PosedPair& pair, double time_step, double depth) {
  if (pair.a.model() == nullptr || pair.b.model() == nullptr) return true;
  const Motion motion_a = Motion::of(*pair.a.wrap().getCollisionObject(), time_step);
  const Motion motion_b = Motion::of(*pair.b.wrap().getCollisionObject(), time_step);
  const Ball ball_a = pair.a.bounding_ball();
  const Ball ball_b = pair.b.bounding_ball();
  const double farthest = find_farthest_displacement(
      motion_a, motion_b, ball_b.radius < ball_a.radius ? ball_b : ball_a, time_step);
  const double thinnest = std::min(pair.a.thinnest(), pair.b.thinnest());
  const double poses = std::ceil(farthest / (kDetailOfThickness * thinnest));
  if (!(poses <= kMostPosesOnTheWay)) return true;
  const auto margin = static_cast<float>(-depth - pair.thickness());
  for (int i = 1; i <= static_cast<int>(poses); ++i) {
    const auto moved = [&](const Side& side, const Motion& motion) {
      return motion.moved(side.world_from_geometry(), i / poses, time_step);
    };
    const Pose world_from_a = moved(pair.a, motion_a);
    const Pose world_from_b = moved(pair.b, motion_b);
    const Pose world_from_shell = pair.shell_is_a ? world_from_a : world_from_b;
    const Pose world_from_field = pair.shell_is_a ? world_from_b : world_from_a;
    const Pose field_from_shell = world_from_field.inverse() * world_from_shell;
    if (collides(pair.field(), pair.shell(), field_from_shell, margin)) return true;
    if (pair.asks_both &&
        collides(pair.second_field(), pair.second_shell(), field_from_shell.inverse(), margin)) {
      return true;
    }
  }
  return false;
}

}  // namespace voxshell::bullet
