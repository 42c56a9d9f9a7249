#pragma once

#include "voxshell/contacts.h"

namespace voxshell {

/// Newtons and newton meters, the shell's frame, about its origin.
struct Wrench {
  Vec3 force{};
  Vec3 torque{};
};

/// Wrench on the shell's body by a penalty of `stiffness` (N/m3, as of a layer of springs): the sum
/// over penetrating points of stiffness * area * depth * gradient, and its moment (Barbic and James
/// 2008, section 4). Gradients are central differences over half a voxel, or half the shell's
/// spacing in an analytic field. The wrench is therefore continuous in the pose: it starts from
/// zero, and no direction jumps between cells. Edge segments have no area and add nothing.
Wrench compute_wrench(const Field& field, const PointShell& shell, const Pose& field_from_shell,
                      double stiffness, QueryScratch& scratch);

}  // namespace voxshell
