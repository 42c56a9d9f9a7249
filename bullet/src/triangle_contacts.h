#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "voxshell/contacts.h"
#include "voxshell/model.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

struct Triangle3f {
  Vec3f a, b, c;
};

/// Where the triangles of one of Bullet's concave shapes reach into a model's field: a mesh or
/// heightfield needs no field of its own, no inside and no preparation, and may change.
///
/// The model's bounds are cut into cells; each that a triangle reaches has one contact, the deepest
/// of points spaced by at most sample_spacing(), moved to the deepest place near it (after Macklin
/// et al. 2020). Its depth is the field's there, so no place of a triangle is deeper by more than
/// the field changes over that spacing.
class TriangleContacts : private btTriangleCallback {
 public:
  /// Contacts as find_contacts() gives them, ascending by id, which is the cell's number; points
  /// and normals in the mesh's frame. There are 2^(level - 1) cells along the model's longest side.
  /// The result lives until the next use.
  std::vector<Contact>& find(const btConcaveShape& mesh, const Model& model,
                             const Pose& model_from_mesh, int level, float margin);

  /// The same in parts, for several poses on a way of the margin's length from this one: the
  /// triangles are looked up once.
  void gather(const btConcaveShape& mesh, const Model& model, const Pose& model_from_mesh,
              float margin);
  /// Places farther than `apart` from the model touch as planes do, meters.
  std::vector<Contact>& find(const Model& model, const Pose& model_from_mesh, int level,
                             float margin, float apart = std::numeric_limits<float>::infinity());
  /// Of the nearest of them from the model, meters; infinity where that is not below `margin`.
  double distance(const Model& model, const Pose& model_from_mesh, float margin);

  /// The voxel, or 1/32 of the model's longest side where that is more. Meters.
  static float sample_spacing(const Model& model);

 private:
  /// A part of a triangle, with the field at its middle.
  struct Piece {
    Triangle3f corners;
    Vec3f middle;
    std::uint32_t triangle;  ///< index into triangles_
    int splits;              ///< that are left
    bool is_leaf;            ///< small enough
    float distance;
    float bound;  ///< no place of the piece has a smaller distance
  };
  struct Batch;
  /// The two pieces of a cell with the least distances, ties to the first met.
  struct CellBest {
    std::uint32_t cell;
    float least;  ///< of the distances of all pieces, the margin at most
    std::size_t count;
    std::array<Piece, 2> pieces;
  };
  /// What refining a piece has come to.
  struct Refined {
    Triangle3f piece;
    std::uint32_t triangle;
    Vec3f deepest;
    float distance;  ///< there
  };

  void processTriangle(btVector3* corners, int part, int index) override;
  void read_triangles(const Pose& model_from_mesh);
  void sample_triangles();
  void take(const Batch& batch);
  Piece* room_for(const Vec3f& middle, float distance, float bound);
  void refine_best();
  Contact contact_of(std::uint32_t cell, const Refined& refined, float apart,
                     const Pose& mesh_from_model) const;
  std::uint32_t cell_of(const Vec3f& p) const;

  const GridField* field_ = nullptr;
  Bounds bounds_;        ///< what is cut into cells
  Bounds within_reach_;  ///< of the margin: outside, triangles do not matter
  float margin_ = 0.0f;
  float spacing_ = 0.0f;
  double cell_size_ = 0.0;
  std::array<std::uint32_t, 3> cells_{};
  bool nearest_alone_ = false;                ///< is looked for, not that of each cell
  std::vector<std::array<Vec3, 3>> corners_;  ///< of the triangles, mesh's frame
  std::vector<Triangle3f> triangles_;         ///< those within reach, model's frame
  std::vector<Piece> waiting_;                ///< within the margin, the next one last
  std::vector<std::uint32_t> place_of_cell_;  ///< in best_, or kNone
  std::vector<CellBest> best_;                ///< of the cells that pieces reach
  std::vector<Refined> refined_;              ///< two a cell, in the order of best_
  std::vector<Contact> contacts_;
};

}  // namespace voxshell::bullet
