#include "foremost.h"

#include "contact_constants.h"
#include "round_touch.h"

namespace voxshell::bullet {

bool is_behind_face(const Contact& contact, const Side& own, const Turning& turning, double reach) {
  const PointShell& shell = *own.participant().shell;
  if (contact.id >= shell.element_count() || static_cast<double>(contact.depth) > reach) {
    return false;
  }
  Vec3 toward = -1.0 * static_cast<Vec3>(contact.normal);
  if (shell.is_point(contact.id)) {
    if (lies_on_curve(*own.model(), contact.id)) return false;
    const auto normal = static_cast<Vec3>(shell.normals()[contact.id]);
    if (turning.may_face(normal, toward, kForemostAngle)) return false;
  } else {
    const auto half = static_cast<Vec3>(shell.edges()->halves()[contact.id - shell.size()]);
    const auto around = around_edge(normalized(half), toward);
    if (!around) return false;
    toward = *around;
  }
  const Vec3 shown = normal_outside(own.model()->grid(), static_cast<Vec3>(contact.point), toward,
                                    kOutsideOfMargin * reach);
  return !turning.may_face(shown, toward, kForemostAngle);
}

}  // namespace voxshell::bullet
