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
  /// Largest error of field and shell, meters. Cells, lists of triangles, points and edge segments
  /// then follow from the shape. To build a uniform model, leave it 0 and give sizes:
  double tolerance = 0.0;
  double voxel_size = 0.0;        ///< meters; or leave it 0 and give:
  int resolution = 0;             ///< voxels along the mesh's longest side
  double point_spacing = 0.0;     ///< meters; 0, and no target: the voxel size
  std::size_t target_points = 0;  ///< reached within 1 %
  double padding = -1.0;          ///< meters of grid beyond the mesh; negative: 16 voxels
  SignMethod sign = SignMethod::kAutomatic;
  /// Treatment of a mesh with open edges. kAutomatic decides by the openings if the sign is
  /// automatic as well; otherwise it makes a solid.
  OpenMesh open = OpenMesh::kAutomatic;
  /// Meters. 0: a 200th of the longest side, and at least two voxels in uniform models. kSolid
  /// ignores it.
  double sheet_thickness = 0.0;
  unsigned threads = 0;  ///< 0: one per core
};

/// A mesh that is ready to collide: distance field, point shell and mass properties, the mixed
/// structure of the thesis (section 5.3). It never changes, so any number of threads and bodies may
/// share it. Meters, the mesh's frame.
class Model {
 public:
  /// Errors: kInvalidArgument, kInvalidMesh, kTooLarge, kCanceled.
  static Result<std::shared_ptr<const Model>> build(TriangleMesh mesh,
                                                    const ModelSettings& settings,
                                                    const Progress& progress = {});

  /// Joins the parts of a model, each of them valid by itself, and checks that they belong
  /// together.
  static Result<std::shared_ptr<const Model>> from_parts(TriangleMesh mesh, GridField field,
                                                         PointShell shell,
                                                         const ModelSettings& settings,
                                                         const Accuracy& accuracy, double thickness,
                                                         const Openings& openings);

  /// As given, except for the tolerance, which is 0 if the model is uniform.
  const ModelSettings& settings() const { return settings_; }
  /// Oriented outward as far as the mesh is closed. For a sheet: its two sides and its rim.
  const TriangleMesh& mesh() const { return mesh_; }
  const Field& field() const { return field_; }
  const GridField& grid() const { return *std::get_if<GridField>(&field_); }
  const PointShell& shell() const { return shell_; }
  /// The smooth surface that the mesh stands for. The first call builds it, and the model keeps it.
  const SmoothSurface& smooth_surface() const;
  const Bounds& bounds() const { return mesh_.bounds(); }
  /// A place deep inside. It detects the body where its surface touches nothing.
  const Vec3f& inner_point() const { return inner_point_; }
  const Accuracy& accuracy() const { return accuracy_; }
  /// Thickness of the body's thinnest walls, meters.
  double thickness() const { return thickness_; }
  /// Openings of the mesh that the model was built from.
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
