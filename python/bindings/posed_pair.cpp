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

Roles choose_roles(const Bodies& bodies, Shells shells) {
  static constexpr std::array kBoth{PairBody::kA, PairBody::kB};
  const auto choose = [&](ShellChoice choice) {
    const PairBody body = unwrap(choose_shell(bodies.a, bodies.b, choice));
    return std::span(kBoth).subspan(body == PairBody::kA ? 0 : 1, 1);
  };
  switch (shells) {
    case Shells::kA:
      return {choose(ShellChoice::kA), false};
    case Shells::kB:
      return {choose(ShellChoice::kB), false};
    case Shells::kBoth:
      choose(ShellChoice::kA);
      choose(ShellChoice::kB);
      return {kBoth, false};
    case Shells::kAutomatic:
      break;
  }
  return {choose(ShellChoice::kAutomatic), true};
}

WorldContact to_world(const Contact& contact, PairBody shell_body, const PairPose& pose) {
  const Pose& world_from_shell = pose.world_from(shell_body);
  const Vec3 on_shell = world_from_shell.transform_point(static_cast<Vec3>(contact.point));
  const Vec3 outwards = world_from_shell.rotate(static_cast<Vec3>(contact.normal));
  // The field's outward normal leads from the shell's point to the field's surface. Adding to zero
  // and subtracting from it leave no negative zeros.
  const Vec3 on_field = on_shell + static_cast<double>(contact.depth) * outwards;
  if (shell_body == PairBody::kA) return {on_shell, on_field, outwards + Vec3{}};
  return {on_field, on_shell, Vec3{} - outwards};
}

}  // namespace voxshell::python
