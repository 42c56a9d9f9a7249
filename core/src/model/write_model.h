#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <variant>

#include "voxshell/model.h"
#include "voxshell/result.h"

namespace voxshell {

/// Takes the next bytes of a file.
using Append = std::function<Result<std::monostate>(std::span<const std::byte>)>;

/// The bytes of a model's file, from the first to the last; see save_model().
Result<std::monostate> write_model(const Model& model, const Append& append);

}  // namespace voxshell
