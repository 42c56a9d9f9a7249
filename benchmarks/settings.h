#pragma once

#include <cstddef>
#include <string>

namespace voxshell::benchmarks {

/// What all cases share.
struct Settings {
  std::string bunny_path = "/usr/share/glmark2/models/bunny.obj";
  double bunny_length = 0.3;        ///< along its longest side, meters
  int resolution = 300;             ///< voxels along that side
  std::size_t fine_points = 34835;  ///< as many as the mesh has vertices
  std::size_t coarse_points = 799;
  std::size_t poses = 240;
  std::size_t cold_poses = 240;
  double seconds = 1.0;        ///< of timed queries, per case
  double build_limit = 120.0;  ///< seconds after which a build is given up
  bool quick = false;

  double voxel_size() const { return bunny_length / resolution; }
};

}  // namespace voxshell::benchmarks
