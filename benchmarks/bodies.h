#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "settings.h"
#include "voxshell/field.h"
#include "voxshell/model.h"
#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::benchmarks {

/// A finished build, or why there is none.
struct Built {
  std::shared_ptr<const Model> model;
  std::string why_not;
  double seconds = 0.0;
  std::vector<std::pair<std::string, double>> stages;  ///< seconds each, in order

  explicit operator bool() const { return model != nullptr; }
};

/// Builds, and gives up after `limit` seconds.
Built build_model(const TriangleMesh& mesh, const ModelSettings& settings, double limit);

/// What collides in the cases; each made when it is first asked for. Ends the program, with a
/// message, where a body that cases rest on cannot be made.
class Bodies {
 public:
  explicit Bodies(const Settings& settings) : settings_(settings) {}

  const Settings& settings() const { return settings_; }
  const TriangleMesh& bunny_mesh();

  /// The bunny with its fine shell; y up, as in its file.
  const Model& bunny();

  /// A slab whose top is the plane z = 0, as wide as a bunny needs, in the bunny's voxels.
  const Model& slab();

  /// A shell of the bunny with another number of points.
  const PointShell& bunny_shell(std::size_t points);

  /// A field of the bunny of another resolution, if it can be built in time.
  const Built& bunny_at(int resolution);

  /// The deepest place of the bunny's inside, as its field has it.
  Vec3 bunny_core();

 private:
  Settings settings_;
  std::optional<TriangleMesh> bunny_mesh_;
  std::optional<Built> bunny_;
  std::optional<Built> slab_;
  std::map<std::size_t, PointShell> shells_;
  std::map<int, Built> resolutions_;
  std::optional<Vec3> core_;
};

}  // namespace voxshell::benchmarks
