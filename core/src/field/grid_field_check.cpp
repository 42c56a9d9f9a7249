#include "field/grid_field_check.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "base/text.h"
#include "field/brick_entry.h"

namespace voxshell {
namespace {

/// Far beyond any mesh, and small enough for sums and squares in float32.
constexpr double kLargestLength = 1e15;  // metres
constexpr double kSmallestVoxel = 1e-15;

Error invalid(std::string message) { return {ErrorCode::kInvalidArgument, std::move(message)}; }

bool is_length(double value) { return value >= 0.0 && value <= kLargestLength; }

Result<std::monostate> check_numbers(const GridFieldData& data) {
  if (!(data.voxel_size >= kSmallestVoxel && data.voxel_size <= kLargestLength)) {
    return invalid(format_text("the voxel size is %g m", data.voxel_size));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = data.surface_bounds.lower[axis];
    const double upper = data.surface_bounds.upper[axis];
    if (!(std::abs(data.origin[axis]) <= kLargestLength) || !(std::abs(lower) <= kLargestLength) ||
        !(std::abs(upper) <= kLargestLength) || !(lower <= upper)) {
      return invalid("its origin or bounds are not finite, or in the wrong order");
    }
  }
  if (!is_length(data.node_error)) return invalid("its error is below zero or not finite");
  double below = 0.0;
  for (const double floor : data.coarse_floors) {
    const bool is_none = floor == static_cast<double>(simd::kNoCoarseFloor);
    if (!(floor >= below) || !(is_none || is_length(floor))) {
      return invalid("its floors are below zero, not finite or in the wrong order");
    }
    below = floor;
  }
  const SignReport& sign = data.sign;
  if (!(sign.confidence >= 0.0 && sign.confidence <= 1.0) || !is_length(sign.cap_error) ||
      !is_finite(sign.first_location) || !is_finite(sign.defects.first_location)) {
    return invalid("what its signs are told to be worth is out of range");
  }
  return std::monostate{};
}

Result<std::monostate> check_sizes(const GridFieldData& data) {
  constexpr int kMostAlongAxis = 1 << 20;  // so that cells are whole numbers in float32
  std::uint64_t count = 1;
  for (const int bricks : data.bricks) {
    if (bricks < 1 || bricks > kMostAlongAxis)
      return invalid(format_text("it is %d bricks wide", bricks));
    count *= static_cast<std::uint64_t>(bricks);
  }
  if (count > std::numeric_limits<std::int32_t>::max() || count != data.entries.size()) {
    return invalid(format_text("%d x %d x %d bricks have %zu entries", data.bricks[0],
                               data.bricks[1], data.bricks[2], data.entries.size()));
  }
  const auto most_samples = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  if (data.samples.size() < simd::kFewestSamples || data.samples.size() > most_samples ||
      data.planes.size() % 4 != 0) {
    return invalid(format_text("it has %zu samples and %zu numbers for planes", data.samples.size(),
                               data.planes.size()));
  }
  return std::monostate{};
}

Result<std::monostate> check_bricks(const GridFieldData& data) {
  for (std::size_t i = 0; i < data.entries.size(); ++i) {
    const BrickEntry entry = BrickEntry::unpack(data.entries[i]);
    const std::size_t have = entry.is_plane ? data.planes.size() / 4 : data.samples.size();
    const auto [row, layer] = entry.strides(data.bricks);
    const auto cells = static_cast<std::size_t>(entry.cells);
    const std::size_t want = entry.is_plane ? 1 : cells * (1 + row + layer) + 1;
    if (entry.first + want > have) {
      return invalid(format_text("brick %zu holds %s %zu to %zu of %zu", i,
                                 entry.is_plane ? "plane" : "samples", entry.first,
                                 entry.first + want - 1, have));
    }
  }
  return std::monostate{};
}

Result<std::monostate> check_planes(const GridFieldData& data) {
  for (std::size_t i = 0; i < data.planes.size(); i += 4) {
    constexpr float kTolerance = 1e-3f;
    const Vec3f normal{data.planes[i], data.planes[i + 1], data.planes[i + 2]};
    if (!(std::abs(squared_length(normal) - 1.0f) <= kTolerance) ||
        !(std::abs(data.planes[i + 3]) <= static_cast<float>(kLargestLength))) {
      return invalid(format_text("plane %zu is none", i / 4));
    }
  }
  return std::monostate{};
}

}  // namespace

Result<std::monostate> check_grid_field(const GridFieldData& data) {
  for (const auto& check : {&check_numbers, &check_sizes, &check_bricks, &check_planes}) {
    if (auto checked = check(data); !checked) return checked;
  }
  return std::monostate{};
}

}  // namespace voxshell
