#pragma once

#include <cstddef>

#include "voxshell/vector.h"

namespace voxshell {

/// Treatment of a mesh with open edges.
enum class OpenMesh {
  kAutomatic,  ///< decided by its openings
  kSolid,      ///< closed: inside is where the winding number is above a half
  kSheet,      ///< kept as a sheet of some thickness, which collides from both sides
};

/// The openings of a mesh, and how the build handled them. Meters, the mesh's frame.
struct Openings {
  std::size_t loops = 0;  ///< rims that do not touch one another; 0: the mesh is not open
  /// Area of caps across the rims, as a fraction of the area of the surface that has rims.
  double fraction = 0.0;
  /// Number of rims that the surface runs into rather than around, as at the ends of a tube.
  std::size_t mouths = 0;
  double largest_diameter = 0.0;  ///< diagonal of the box around the largest rim
  Vec3 first_location{};          ///< the middle of an edge of the first rim
  double sheet_thickness = 0.0;   ///< 0: not a sheet
};

}  // namespace voxshell
