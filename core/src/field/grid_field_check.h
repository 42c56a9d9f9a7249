#pragma once

#include <variant>

#include "voxshell/grid_field.h"
#include "voxshell/result.h"

namespace voxshell {

/// Whether data that comes from outside is sound: sizes that agree, every brick's numbers within
/// the arrays, everything finite. Not whether the distances are true. Error: kInvalidArgument.
Result<std::monostate> check_grid_field(const GridFieldData& data);

}  // namespace voxshell
