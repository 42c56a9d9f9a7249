#pragma once

#include "voxshell/grid_field.h"

namespace voxshell {

/// Works out how far around each brick that holds a plane nothing else matters, in a field that has
/// everything else; see simd/grid_view.h.
void measure_plane_surroundings(GridFieldData& data, unsigned threads);

}  // namespace voxshell
