#pragma once

#include <stdint.h>

#include "simd/edge_view.h"
#include "simd/isa.h"
#include "simd/posed_view.h"
#include "simd/tree_view.h"

namespace voxshell::simd {

inline constexpr uint32_t kNone = UINT32_MAX;

/// Spheres of one level of the walk, ascending. A tag above 0 says that all points within see
/// nothing of the field but its plane tag - 1.
struct NodeList {
  uint32_t* index;
  uint32_t* tag;
  float* bound;  ///< no point within has a smaller distance, meters; may be null
  uint32_t count;
};

/// Points of the shell with their distances and the tags of their spheres, ascending by id; room
/// for kLanes more.
struct PointList {
  uint32_t* id;
  uint32_t* tag;
  float* distance;
  float *x, *y, *z;  ///< the shell's frame, meters
  uint32_t count;
};

/// Where searches begin: what is left of the tree after some levels of the walk, at most kMostSeeds
/// spheres. `level` is that of their children; the root's is 0.
struct Seeds {
  NodeList nodes;
  int level;
};
inline constexpr uint32_t kMostSeeds = 512;

/// A search for the next point of a manifold (thesis, section 5.3): the first is the deepest,
/// `chosen` are the ones already found.
struct ManifoldSearch {
  float chosen[3][3];  ///< their points, the shell's frame, meters
  int count;           ///< 1 to 3
};

struct FoundPoint {
  uint32_t id;  ///< or kNone
  float distance;
  float point[3];
  float score = 0.0f;  ///< the area that it adds to a manifold, where that was asked for
};

/// Poses of which one is to bring what is looked for below its margin; or none, and nothing is
/// asked of it.
template <class V>
struct Arrivals {
  const PosedView<V>* posed;
  const float* margins;  ///< meters
  uint32_t count;
};

/// The work of queries on one kind of field, compiled for one instruction set.
template <class V>
struct QueryKernels {
  /// Appends to `out` those children of `nodes` that may hold a point below `margin`. `level` is
  /// theirs; those of the root, node 0, are level 0. Every sphere counts as larger by `growth`.
  void (*expand)(const PosedView<V>&, const TreeView&, int level, const NodeList& nodes,
                 NodeList& out, float margin, float growth);
  /// Lists those points of slots that may come below `margin` when they move by up to `growth`,
  /// with bounds of their distances then. Tags must be of this margin and no smaller growth.
  void (*sift)(const PosedView<V>&, const TreeView&, const NodeList& slots, float margin,
               float growth, PointList& out);
  /// Appends the points below `margin` of slots.
  void (*evaluate)(const PosedView<V>&, const TreeView&, const NodeList& slots, float margin,
                   PointList& out);
  /// Appends those of `sifted` points that are below `margin`.
  void (*evaluate_sifted)(const PosedView<V>&, const PointList& sifted, float margin,
                          PointList& out);
  /// Writes a contact (id, depth, point, normal) for each point, eight words each. Points with a
  /// tag must have been found below the margin that it was given for.
  void (*complete)(const PosedView<V>&, const TreeView&, const PointList& points, void* contacts);
  /// Gradients by central differences over `step` meters to either side, the shell's frame: unlike
  /// those of complete(), continuous in the pose, and shorter than 1 across a ridge. Room for
  /// kLanes more.
  void (*differentiate)(const PosedView<V>&, const PointList& points, float step, float* x,
                        float* y, float* z);
  /// Drops spheres of a level that hold no point that arrives, if they count as larger by `growth`.
  void (*keep_arriving_spheres)(const Arrivals<V>&, const TreeView&, int level, float growth,
                                NodeList& nodes);
  /// Drops points that do not arrive within `growth` of the margins.
  void (*keep_arriving_points)(const Arrivals<V>&, float growth, PointList& points);
  /// The smallest distance below `margin` in each of 2^segment_depth clusters, of the points that
  /// arrive, ties to the smaller id; segment_depth must not be above the tree's. `best` holds one
  /// entry each, none found.
  void (*find_deepest)(const PosedView<V>&, const TreeView&, const Seeds&, int segment_depth,
                       float margin, const Arrivals<V>&, FoundPoint* best);
  /// Whether any point lies below `margin`.
  bool (*find_any)(const PosedView<V>&, const TreeView&, float margin);
  /// The point below `margin` that makes the manifold's area largest, ties to the smaller id.
  FoundPoint (*find_widest)(const PosedView<V>&, const TreeView&, const Seeds&,
                            const ManifoldSearch&, float margin);
  /// The same of listed points.
  FoundPoint (*choose_widest)(const PointList& points, const ManifoldSearch&);
  /// Finds the place of the least distance on each of the listed pieces of edges, which sift()
  /// finds by their middles with a growth of `reach`. Appends those places that are below `margin`,
  /// by the ids of the pieces.
  void (*refine_edges)(const PosedView<V>&, const EdgeView&, const PointList& pieces, float margin,
                       PointList& out);
  /// Finds the deepest such place below `margin` of each group of listed pieces, which end at
  /// `group_ends`; ties to the smaller id.
  void (*find_deepest_edges)(const PosedView<V>&, const EdgeView&, const PointList& pieces,
                             const uint32_t* group_ends, uint32_t group_count, float margin,
                             FoundPoint* best);
  /// Whether any such place lies below `margin`.
  bool (*find_any_edge)(const PosedView<V>&, const EdgeView&, float margin);
  /// The deepest of them, ties to the smaller id.
  FoundPoint (*find_deepest_edge)(const PosedView<V>&, const EdgeView&, float margin);
  /// Whether any of listed points may come below `margin` when it moves by up to `growth`. They are
  /// those that sift() lists for that: near the surface this tells more.
  bool (*may_come_below)(const PosedView<V>&, const PointList& sifted, float margin, float growth);
  /// The same of pieces of edges.
  bool (*may_edges_come_below)(const PosedView<V>&, const EdgeView&, const PointList& pieces,
                               float margin, float growth);
};

/// The views that there are kernels for.
#define VOXSHELL_FOR_EACH_VIEW(DO) \
  DO(GridView)                     \
  DO(ExactGridView)                \
  DO(PlaneView)                    \
  DO(BoxView) DO(SphereView) DO(CapsuleView) DO(CylinderView) DO(ConeView) DO(ConvexView)

template <class V>
const QueryKernels<V>& query_kernels(Isa isa);

}  // namespace voxshell::simd
