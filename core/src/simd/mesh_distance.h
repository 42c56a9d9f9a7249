#pragma once

#include <stdint.h>

namespace voxshell::simd {

/// Numbers that one triangle is described by. With p a point:
///   height of p over its plane         normal . p - height
///   position along edge i              along_i . p, on the edge from low_i to high_i
///   distance inwards from edge i       inward_i . p - side_i
/// normal, along_i and inward_i are unit vectors at right angles to one another, so that the
/// squared distance to an edge is that of the height, the side, and how far the position is off the
/// edge. A triangle that is too thin to have a normal is told as its longest edge.
enum TriangleField {
  kNormal = 0,
  kHeight = 3,
  kFirstEdge = 4,
  kEdgeFields = 9,
  kAlong = 0,
  kLow = 3,
  kHigh = 4,
  kInward = 5,
  kSide = 8,
  kTriangleFields = kFirstEdge + 3 * kEdgeFields,
};

/// Triangles stand in blocks of eight: field f of triangle i of a block is its number 8 f + i.
inline constexpr int32_t kBlockTriangles = 8;
inline constexpr int64_t kBlockFloats = int64_t{kTriangleFields} * kBlockTriangles;

/// Eight boxes, which hold nodes or blocks. Lower and upper x, y, z of the eight; a box without
/// anything in it is infinitely far away.
struct BoxNode {
  float lower[3][8];
  float upper[3][8];
  int32_t child[8];  ///< a node, or the complement of a block
};

/// The triangles of a mesh in a tree of boxes. One unit for all lengths.
struct MeshTreeView {
  const BoxNode* nodes;  ///< the first is the root
  const float* blocks;
  const float* centers;  ///< of the blocks: their triangles are told from there
  float slack;           ///< outweighs the rounding of positions, in the boxes' distances
};

struct Nearest {
  float distance;
  int32_t triangle;  ///< 8 times its block, and its place there
};

/// Working memory for measuring a brick. All arrays have room for `most_blocks`.
struct BrickScratch {
  int32_t most_blocks;
  int32_t* blocks;
  float* moved;      ///< kBlockFloats a block
  float* gathered;   ///< kBlockFloats a block
  float* squared;    ///< 8 a block
  int32_t* nearby;   ///< 8 a block
  int32_t* nearest;  ///< 8 a block
};

struct MeshDistanceKernels {
  /// The triangle nearest to p; `guess` is any block, best one near.
  Nearest (*find_nearest)(const MeshTreeView& tree, const double* p, int32_t guess);

  /// The blocks whose boxes come within `radius` of p, in a fixed order; -1 where they are more
  /// than `most`.
  int32_t (*find_blocks)(const MeshTreeView& tree, const double* p, float radius, int32_t most,
                         int32_t* found);

  /// Distances of 9^3 nodes one unit apart, x fastest, with `center` in the middle, whose own
  /// distance is `at_center`. False, with nothing done, where too many triangles may be the
  /// nearest.
  bool (*measure_brick)(const MeshTreeView& tree, const double* center, float at_center,
                        const BrickScratch& scratch, float* distances);

  /// Squared distances of p from listed triangles, and of some more to fill up eight. `records` as
  /// in simd/exact_view.h.
  void (*measure_listed)(const float* records, const uint32_t* listed, uint32_t count,
                         const float* p, float* squared);

  /// Of eight places (all x, all y, all z) the nearest of listed triangles, as an index of the
  /// list. Those that are farther by at most `reach` get a 1 in `may_be_nearest`; the others keep
  /// what stands there. And the chord between the normals of the nearest and of that one of these
  /// which differs most. `work` has room for eight numbers a triangle.
  void (*compare_listed)(const float* records, const uint32_t* listed, uint32_t count,
                         const float* places, float reach, float* work, uint8_t* may_be_nearest,
                         float* squared, int32_t* nearest, float* squared_chord);

  /// The signed distances of places (x, y, z of each) from the nearest of listed triangles.
  void (*evaluate_listed)(const float* records, const float* feature_normals,
                          const uint32_t* listed, uint32_t count, const float* places,
                          uint32_t place_count, float* distances);
};

/// For the active instruction set; all give the same bits.
const MeshDistanceKernels& mesh_distance_kernels();

extern const MeshDistanceKernels kPortableMeshDistance;
extern const MeshDistanceKernels kAvx2MeshDistance;

}  // namespace voxshell::simd
