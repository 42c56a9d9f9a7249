#include "query/traverse.h"
#include "voxshell/contacts.h"

namespace voxshell {

bool collides(const Field& field, const PointShell& shell, const Pose& field_from_shell,
              float margin) {
  const auto points = shell.points();
  return with_posed_field(field, shell, field_from_shell, [&](const auto& posed) {
    return !visit_points_below(posed, shell, margin, [&](std::uint32_t id) {
      return !(posed.distance(points[id]) < margin);
    });
  });
}

}  // namespace voxshell
