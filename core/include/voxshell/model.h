#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

#include "voxshell/accuracy.h"
#include "voxshell/field.h"
#include "voxshell/mass_properties.h"
#include "voxshell/openings.h"
#include "voxshell/point_shell.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/smooth_surface.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

struct ModelSettings {
  /// Metres that field and shell may be off the surface. Cells, lists of triangles, points and edge
  /// segments are then chosen by the shape. Or leave it 0 and give sizes for a uniform model:
  double tolerance = 0.0;
  double voxel_size = 0.0;        ///< metres; or leave it 0 and give:
  int resolution = 0;             ///< voxels along the mesh's longest side
  double point_spacing = 0.0;     ///< metres; neither this nor a target: the voxel size
  std::size_t target_points = 0;  ///< reached within 1 %
  double padding = -1.0;          ///< metres of grid beyond the mesh; negative: 16 voxels
  SignMethod sign = SignMethod::kAutomatic;
  /// What a mesh with open edges becomes. Decided by its openings only where the sign is automatic,
  /// too; else automatic means a solid.
  OpenMesh open = OpenMesh::kAutomatic;
  /// Metres; 0: a 200th of the longest side, of uniform models at least two voxels. With kSolid:
  /// unused.
  double sheet_thickness = 0.0;
  unsigned threads = 0;  ///< 0: one a core
};

/// A mesh made ready to collide: distance field, point shell and mass properties, the thesis' mixed
/// structure (section 5.3). Immutable, so that any number of threads and bodies may share it.
/// Metres, the mesh's frame.
class Model {
 public:
  /// Errors: kInvalidArgument, kInvalidMesh, kTooLarge, kCancelled.
  static Result<std::shared_ptr<const Model>> build(TriangleMesh mesh,
                                                    const ModelSettings& settings,
                                                    const Progress& progress = {});

  /// From what a model consists of, each part sound by itself: checks that they belong together.
  static Result<std::shared_ptr<const Model>> from_parts(TriangleMesh mesh, GridField field,
                                                         PointShell shell,
                                                         const ModelSettings& settings,
                                                         const Accuracy& accuracy, double thickness,
                                                         const Openings& openings);

  /// As they were given, but for the tolerance: 0 if the model is uniform.
  const ModelSettings& settings() const { return settings_; }
  /// Right side out, as far as it is closed. Of a sheet: its two sides and its rim.
  const TriangleMesh& mesh() const { return mesh_; }
  const Field& field() const { return field_; }
  const GridField& grid() const { return *std::get_if<GridField>(&field_); }
  const PointShell& shell() const { return shell_; }
  /// What the mesh stands for; made when it is first asked for, and kept.
  const SmoothSurface& smooth_surface() const;
  const Bounds& bounds() const { return mesh_.bounds(); }
  /// A place deep inside, by which the body is found where its surface touches nothing.
  const Vec3f& inner_point() const { return inner_point_; }
  const Accuracy& accuracy() const { return accuracy_; }
  /// Of the body where it is thinnest, metres.
  double thickness() const { return thickness_; }
  /// Of the mesh that it was built from.
  const Openings& openings() const { return openings_; }
  const MassProperties& solid_mass_properties() const { return solid_; }      ///< at 1 kg
  const MassProperties& surface_mass_properties() const { return surface_; }  ///< at 1 kg

 private:
  Model(TriangleMesh mesh, GridField field, PointShell shell, const ModelSettings& settings,
        const Accuracy& accuracy, double thickness, const Openings& openings);

  static Vec3f find_inner_point(const GridField& field, const PointShell& shell);

  TriangleMesh mesh_;
  Field field_;
  PointShell shell_;
  Vec3f inner_point_ = find_inner_point(grid(), shell_);
  MassProperties solid_;
  MassProperties surface_;
  ModelSettings settings_;
  Accuracy accuracy_;
  double thickness_;
  Openings openings_;
  mutable std::once_flag smooth_surface_once_;
  mutable std::unique_ptr<const SmoothSurface> smooth_surface_;
};

}  // namespace voxshell
