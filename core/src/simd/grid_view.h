#pragma once

#include <stdint.h>

namespace voxshell::simd {

/// A brick is a cube of kBrickCells^3 cells of one voxel. Its entry says what it holds:
///   bits 0-1   log2 of n: (n + 1)^3 samples, n = 1, 2, 4 or 8 to a side, x fastest
///   bit  2     a plane instead of samples
///   bits 3-6   samples: the exponent e of their scale, quantum * 2^e
///              plane: how many bricks around it, in each direction, hold the same plane or neither
///              it nor the surface within plane_margin; the grid may end there
///   bits 7-31  samples: index of the first, in units of kSampleAlignment; plane: its index
/// Bricks of one cell share their corners: where there are any, samples begin with those of all
/// bricks, x fastest, at one scale, and the index is in units of one.
inline constexpr int kBrickCells = 8;
inline constexpr int kBrickShift = 3;
inline constexpr int kPlaneBit = 4;
inline constexpr int kFieldShift = 3;
inline constexpr int kFieldMask = 15;
inline constexpr int kPayloadShift = 7;
inline constexpr int kSampleAlignment = 4;
/// Samples that a lane without any may read all the same.
inline constexpr int kFewestSamples = 1024;
/// How many sizes of cells larger than a voxel there are: 2, 4 and 8.
inline constexpr int kCoarseSizes = 3;
/// Says that no brick has cells as large as that.
inline constexpr float kNoCoarseFloor = 1e30f;

/// A grid field as kernels see it. Meters, the field's frame.
struct GridView {
  uint64_t serial;          ///< of the field; see base/serial.h
  const uint32_t* entries;  ///< one a brick, x fastest
  const int16_t* samples;   ///< at least kFewestSamples
  const float* planes;      ///< normal x, y, z and offset of each
  float origin[3];          ///< of the first cell
  float cells[3];           ///< along each axis; a multiple of kBrickCells
  int32_t last_brick[3];
  int32_t bricks_x;   ///< bricks in a row
  int32_t bricks_xy;  ///< bricks in a layer
  int32_t rows[8];    ///< how far samples are apart along y, by the lowest three bits of an entry
  int32_t layers[8];  ///< along z
  float voxel_size;
  float inverse_voxel_size;
  float quantum;  ///< a sample's unit at scale exponent 0, meters
  /// |node or plane - true distance| and |value - true distance| in cells of one voxel, meters. In
  /// larger cells they are as many times that as these are voxels wide.
  float node_error;
  float fine_error;
  /// Trilinear weights spread nodes about a point; the mean of their squared distances from it is
  /// at most this in cells of one voxel, meters^2, and grows with the square of the cell's size.
  float spread;
  /// The true distances of two nodes d apart differ by at most sqrt(d^2 + gap), meters^2.
  float gap;
  float plane_margin;  ///< up to which a plane serves for all that is around it, meters
  /// In bricks with cells of 2, 4 and 8 voxels, or larger, no point is nearer to the surface than
  /// this and no value nearer to zero, meters, ascending; or kNoCoarseFloor.
  float coarse_floors[kCoarseSizes];

  /// Fields do not change once they have a serial.
  friend bool operator==(const GridView& a, const GridView& b) { return a.serial == b.serial; }
};

}  // namespace voxshell::simd
