#pragma once

#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

/// Mass, center and inertia of a body. Kilograms, meters, the mesh's frame and axes; the inertia
/// tensor is about the center of mass.
struct MassProperties {
  double mass = 1.0;
  Vec3 center_of_mass{};
  Matrix3 inertia{};

  /// The same body with another mass.
  MassProperties with_mass(double new_mass) const;
};

/// Mass properties of the homogeneous solid that a closed mesh encloses, at mass 1 kg. Uses
/// tetrahedra to the origin (Tonon 2004).
MassProperties compute_solid_mass_properties(const TriangleMesh& mesh);

/// Mass properties of a homogeneous thin skin on the mesh's triangles, at mass 1 kg. The tensor
/// that the thesis uses for its bunny (section 5.3) is of this kind.
MassProperties compute_surface_mass_properties(const TriangleMesh& mesh);

}  // namespace voxshell
