#include "posed_pair.h"

#include <algorithm>
#include <array>

#include "errors.h"

namespace voxshell::python {

Pose read_matrix(const double* matrix, const std::string& name) {
  std::array<double, 16> numbers{};
  std::copy_n(matrix, numbers.size(), numbers.begin());
  return unwrap(Pose::from_matrix(numbers), name.c_str());
}

Pose read_pose(const OptionalPose& pose, const char* name) {
  if (!pose) return {};
  return read_matrix(pose->numbers.data(), name);
}

Roles choose_roles(const Bodies& bodies, ShellChoice choice) {
  static constexpr std::array kBodies{PairBody::kA, PairBody::kB};
  const PairRole pair = unwrap(decide_role(bodies.a, bodies.b, choice));
  const std::span<const PairBody> all(kBodies);
  const std::size_t count = pair.role == Role::kBoth ? 2 : 1;
  return {all.subspan(pair.role == Role::kB ? 1 : 0, count), choice == ShellChoice::kFewest,
          choice == ShellChoice::kAutomatic || choice == ShellChoice::kBoth};
}

WorldContact to_world(const Contact& contact, PairBody shell_body, const PairPose& pose) {
  const Pose& world_from_shell = pose.world_from(shell_body);
  const Vec3 on_shell = world_from_shell.transform_point(static_cast<Vec3>(contact.point));
  const Vec3 outwards = world_from_shell.rotate(static_cast<Vec3>(contact.normal));
  // The field's outward normal points from the shell's point to the field's surface. Adding to zero
  // and subtracting from it avoid negative zeros.
  const Vec3 on_field = on_shell + static_cast<double>(contact.depth) * outwards;
  if (shell_body == PairBody::kA) return {on_shell, on_field, outwards + Vec3{}};
  return {on_field, on_shell, Vec3{} - outwards};
}

}  // namespace voxshell::python
