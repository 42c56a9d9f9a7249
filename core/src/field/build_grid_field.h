#pragma once

#include <optional>

#include "mesh/repair.h"
#include "mesh/surface_cutter.h"
#include "voxshell/grid_field.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"

namespace voxshell {

/// A field, and what of the mesh it is the distance to, where that is not all of it: of the mesh
/// that is right side out.
struct BuiltField {
  GridField field;
  std::optional<VisibleSurface> visible;
};

/// As GridField::build(), whose errors it has.
Result<BuiltField> build_grid_field(const RepairedMesh& repaired, const GridFieldSettings& settings,
                                    const Progress& progress);

}  // namespace voxshell
