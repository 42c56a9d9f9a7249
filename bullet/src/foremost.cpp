#include "foremost.h"

#include "contact_constants.h"
#include "contact_list.h"
#include "round_touch.h"

namespace voxshell::bullet {

void drop_behind_faces(std::vector<Contact>& contacts, const Side& own, const Turning& turning,
                       double reach) {
  const PointShell& shell = *own.participant().shell;
  keep_if(contacts, [&](const Contact& contact) {
    if (contact.id >= shell.element_count() || static_cast<double>(contact.depth) > reach) {
      return true;
    }
    Vec3 toward = -1.0 * static_cast<Vec3>(contact.normal);
    if (shell.is_point(contact.id)) {
      if (lies_on_curve(*own.model(), contact.id)) return true;
      const auto normal = static_cast<Vec3>(shell.normals()[contact.id]);
      if (turning.may_face(normal, toward, kForemostAngle)) return true;
    } else {
      const auto half = static_cast<Vec3>(shell.edges()->halves()[contact.id - shell.size()]);
      const auto around = around_edge(normalized(half), toward);
      if (!around) return true;
      toward = *around;
    }
    const Vec3 shown = normal_outside(own.model()->grid(), static_cast<Vec3>(contact.point), toward,
                                      kOutsideOfMargin * reach);
    return turning.may_face(shown, toward, kForemostAngle);
  });
}

}  // namespace voxshell::bullet
