#include "voxshell/distance.h"

#include "voxshell/manifold.h"

namespace voxshell {

std::optional<Contact> find_nearest(const Field& field, const PointShell& shell,
                                    const Pose& field_from_shell, float max_distance,
                                    QueryScratch& scratch) {
  const auto found = find_manifold(field, shell, field_from_shell, max_distance, scratch, 1);
  if (found.empty()) return std::nullopt;
  return found[0];
}

}  // namespace voxshell
