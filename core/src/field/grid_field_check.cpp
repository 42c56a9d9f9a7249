#include "field/grid_field_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "base/text.h"
#include "field/brick_entry.h"
#include "simd/exact_view.h"

namespace voxshell {
namespace {

/// Far beyond any mesh, and small enough for sums and squares in float32.
constexpr double kLargestLength = 1e15;  // meters
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
  constexpr int kMostQuanta = 1 << 14;
  if (data.quanta_per_voxel < 1 || data.quanta_per_voxel > kMostQuanta ||
      !std::has_single_bit(static_cast<unsigned>(data.quanta_per_voxel))) {
    return invalid(format_text("a voxel has %d quanta", data.quanta_per_voxel));
  }
  if (!is_length(data.node_error) || !is_length(data.surface_error))
    return invalid("its error is below zero or not finite");
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
    return invalid("its sign confidence is out of range");
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
      return invalid(
          format_text("plane %zu: normal is not of unit length, or offset is too large", i / 4));
    }
  }
  return std::monostate{};
}

/// Every index of exact cells is in range and every number finite.
Result<std::monostate> check_exact_cells(const GridFieldData& data) {
  const ExactCells& exact = data.exact;
  constexpr std::size_t kWords = 2 * std::size_t{simd::kMaskWords};
  const std::size_t bricks = exact.masks.size() / kWords;
  const std::size_t triangles = exact.triangles.size() / simd::kTriangleFloats;
  if ((!exact.bricks.empty() && exact.bricks.size() != data.entries.size()) ||
      exact.masks.size() % kWords != 0 || exact.triangles.size() % simd::kTriangleFloats != 0 ||
      exact.feature_normals.size() != simd::kFeatureNormalFloats * triangles) {
    return invalid(
        format_text("its exact cells have %zu bricks, %zu masks, %zu numbers of "
                    "triangles and %zu of normals",
                    exact.bricks.size(), exact.masks.size(), exact.triangles.size(),
                    exact.feature_normals.size()));
  }
  for (std::size_t i = 0; i < exact.bricks.size(); ++i) {
    if (exact.bricks[i] == 0) continue;
    const BrickEntry entry = BrickEntry::unpack(data.entries[i]);
    if (exact.bricks[i] > bricks || entry.is_plane || entry.cells != simd::kBrickCells) {
      return invalid(format_text("brick %zu cannot have the exact cells %u of %zu", i,
                                 exact.bricks[i] - 1, bricks));
    }
  }
  for (std::size_t i = 0; i < exact.masks.size(); i += kWords) {
    for (std::size_t word = i; word < i + simd::kMaskWords; ++word) {
      const std::size_t first = exact.masks[word + simd::kMaskWords];
      const auto count = static_cast<std::size_t>(std::popcount(exact.masks[word]));
      if (first + count > exact.lists.size()) {
        return invalid(
            format_text("mask %zu of exact cells goes beyond %zu lists", word, exact.lists.size()));
      }
    }
  }
  for (const std::uint32_t list : exact.lists) {
    const std::size_t first = list >> simd::kListCountBits;
    const std::size_t count = list & simd::kMostInList;
    if (count == 0 || first + count > exact.listed.size()) {
      return invalid(format_text("a list has triangles %zu to %zu of %zu", first, first + count,
                                 exact.listed.size()));
    }
  }
  for (const std::uint32_t triangle : exact.listed) {
    if (triangle >= triangles) {
      return invalid(format_text("a list names triangle %u of %zu", triangle, triangles));
    }
  }
  const auto is_number = [](float value) {
    return std::abs(value) <= static_cast<float>(kLargestLength);
  };
  if (!std::ranges::all_of(exact.triangles, is_number) ||
      !std::ranges::all_of(exact.feature_normals, is_number)) {
    return invalid("a number of a triangle or a normal is not finite");
  }
  return std::monostate{};
}

}  // namespace

Result<std::monostate> check_grid_field(const GridFieldData& data) {
  for (const auto& check :
       {&check_numbers, &check_sizes, &check_bricks, &check_planes, &check_exact_cells}) {
    if (auto checked = check(data); !checked) return checked;
  }
  return std::monostate{};
}

}  // namespace voxshell
