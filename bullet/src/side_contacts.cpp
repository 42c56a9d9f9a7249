#include "side_contacts.h"

#include <cstdint>

#include "contact_constants.h"
#include "second_shell.h"

namespace voxshell::bullet {

bool is_beside(const PairStep& step, const Contact& contact) {
  const PosedPair& pair = *step.pair;
  if (pair.has_triangles() || contact.id >= kInnerContact) return false;
  const bool is_second = contact.id >= kFirstOfSecond;
  const Side& side = is_second ? pair.field_side() : pair.shell_side();
  if (step.larger != &side && !pair.asks_both) return false;
  const PointShell& shell = *side.participant().shell;
  const std::uint32_t id = is_second ? contact.id - kFirstOfSecond : contact.id;
  if (id >= shell.size()) return false;  // an edge is as sharp as it looks
  Vec3f point = contact.point;
  Vec3f outwards = contact.normal;
  if (is_second) {
    point = static_cast<Vec3f>(step.field_from_shell.transform_point(place_of_second(contact)));
    outwards = static_cast<Vec3f>(-step.field_from_shell.rotate(static_cast<Vec3>(contact.normal)));
  }
  if (dot(shell.normals()[id], outwards) < kOpposedByLess) return false;
  const auto spacing = static_cast<float>(shell.spacing());
  if (contact.depth > spacing) return false;
  const Vec3f in_front = point - spacing * outwards;
  return side.model()->grid().distance(in_front) < kFreeInFront * spacing;
}

void drop_beside(const PairStep& step, std::vector<Contact>& contacts) {
  if (step.larger == nullptr && !step.pair->asks_both) return;
  std::erase_if(contacts, [&](const Contact& contact) { return is_beside(step, contact); });
}

}  // namespace voxshell::bullet
