#include "side_contacts.h"

#include <algorithm>
#include <cstdint>

#include "contact_constants.h"
#include "second_shell.h"

namespace voxshell::bullet {

bool is_beside(const PairStep& step, const Contact& contact, const Vec3f& normal) {
  const PosedPair& pair = *step.pair;
  if (pair.has_triangles() || contact.id >= kInnerContact) return false;
  const bool is_second = contact.id >= kFirstOfSecond;
  const Side& side = is_second ? pair.field_side() : pair.shell_side();
  if (step.larger != &side && !pair.asks_both) return false;
  const PointShell& shell = *side.participant().shell;
  const std::uint32_t id = is_second ? contact.id - kFirstOfSecond : contact.id;
  Vec3f point = contact.point;
  Vec3f outwards = normal;
  if (is_second) {
    point = static_cast<Vec3f>(step.field_from_shell.transform_point(place_of_second(contact)));
    outwards = static_cast<Vec3f>(-step.field_from_shell.rotate(static_cast<Vec3>(normal)));
  }
  const bool is_point = shell.is_point(id);
  if (is_point && dot(shell.normals()[id], outwards) < kOpposedByLess) return false;
  const double spacing = shell.spacing();
  const auto reach = static_cast<float>(
      is_point ? spacing : std::min(spacing, kEdgeReachOfRadius * step.ball.radius));
  if (contact.depth > reach) return false;
  const Vec3f in_front = point - reach * outwards;
  return side.model()->grid().distance(in_front) < kFreeInFront * reach;
}

bool is_steep(const PairStep& step, const Contact& contact) {
  const PosedPair& pair = *step.pair;
  if (pair.has_triangles() || contact.id >= kInnerContact) return false;
  const bool is_second = contact.id >= kFirstOfSecond;
  const Side& side = is_second ? pair.field_side() : pair.shell_side();
  const PointShell& shell = *side.participant().shell;
  const std::uint32_t id = is_second ? contact.id - kFirstOfSecond : contact.id;
  if (!shell.is_point(id) || side.model()->settings().tolerance == 0.0) return false;
  const auto outwards = static_cast<Vec3>(shell.normals()[id]);
  auto direction = -static_cast<Vec3>(contact.normal);
  if (is_second) direction = -step.field_from_shell.rotate(direction);
  return !turning_of(step, is_second).may_face(outwards, direction, kSteep);
}

}  // namespace voxshell::bullet
