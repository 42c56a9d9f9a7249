#include "bodies.h"

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string_view>

#include "support/meshes.h"

namespace voxshell::benchmarks {
namespace {

[[noreturn]] void give_up(const std::string& why) {
  std::cerr << "voxshell_benchmarks: " << why << '\n';
  std::exit(1);
}

/// The vertices and triangles of a Wavefront file, the rest of it left aside.
test_support::Soup read_obj(const std::string& path) {
  std::ifstream file(path);
  if (!file) give_up("cannot read " + path + " (Debian, Ubuntu: apt install glmark2-data)");
  test_support::Soup soup;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3& v = soup.vertices.emplace_back();
      words >> v.x >> v.y >> v.z;
    } else if (kind == "f") {
      Triangle& t = soup.triangles.emplace_back();
      for (std::uint32_t& corner : t) {
        std::string word;
        words >> word;
        corner = static_cast<std::uint32_t>(std::strtoul(word.c_str(), nullptr, 10) - 1);
      }
    }
  }
  return soup;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

const Model& require(const Built& built, std::string_view name) {
  if (!built) give_up("cannot build the " + std::string(name) + ": " + built.why_not);
  return *built.model;
}

}  // namespace

Built build_model(const TriangleMesh& mesh, const ModelSettings& settings, double limit) {
  Built built;
  const auto start = std::chrono::steady_clock::now();
  std::string last_stage;
  double stage_start = 0.0;
  const auto end_stage = [&](double now) {
    if (!last_stage.empty()) built.stages.emplace_back(last_stage, now - stage_start);
    stage_start = now;
  };
  char stopped[160] = "";
  const auto watch = [&](std::string_view stage, double fraction) {
    const double now = seconds_since(start);
    if (stage != last_stage) {
      end_stage(now);
      last_stage = stage;
    }
    if (now <= limit) return true;
    std::snprintf(stopped, sizeof(stopped), "stopped after %.0f s, %.0f %% into its stage \"%s\"",
                  now, 100.0 * fraction, last_stage.c_str());
    return false;
  };
  auto model = Model::build(mesh, settings, watch);
  built.seconds = seconds_since(start);
  end_stage(built.seconds);
  if (model) {
    built.model = *std::move(model);
  } else {
    built.why_not = stopped[0] != '\0' ? stopped : model.error().message;
  }
  return built;
}

const TriangleMesh& Bodies::bunny_mesh() {
  if (!bunny_mesh_) {
    test_support::Soup soup = read_obj(settings_.bunny_path);
    Bounds bounds;
    for (const Vec3& v : soup.vertices) bounds.extend(v);
    const double longest = bounds.extents()[bounds.longest_axis()];
    for (Vec3& v : soup.vertices) {
      v = (settings_.bunny_length / longest) * (v - bounds.center());
    }
    auto mesh = TriangleMesh::create(soup.vertices, soup.triangles);
    if (!mesh) give_up(settings_.bunny_path + ": " + mesh.error().message);
    bunny_mesh_ = *std::move(mesh);
  }
  return *bunny_mesh_;
}

const Model& Bodies::bunny() {
  if (!bunny_) {
    bunny_ = build_model(
        bunny_mesh(),
        {.voxel_size = settings_.voxel_size(), .target_points = settings_.fine_points}, 1e9);
  }
  return require(*bunny_, "bunny");
}

const Model& Bodies::slab() {
  if (!slab_) {
    constexpr double kHalfWidth = 0.25;
    constexpr double kHalfHeight = 0.025;
    const auto soup = test_support::moved(
        test_support::make_box({kHalfWidth, kHalfWidth, kHalfHeight}), {0.0, 0.0, -kHalfHeight});
    slab_ = build_model(soup.mesh(), {.voxel_size = settings_.voxel_size(), .target_points = 1000},
                        1e9);
  }
  return require(*slab_, "slab");
}

const PointShell& Bodies::bunny_shell(std::size_t points) {
  auto found = shells_.find(points);
  if (found == shells_.end()) {
    auto shell = PointShell::build(bunny_mesh(), {.target_points = points});
    if (!shell) give_up("cannot sample the bunny: " + shell.error().message);
    found = shells_.emplace(points, *std::move(shell)).first;
  }
  return found->second;
}

const Built& Bodies::bunny_at(int resolution) {
  auto found = resolutions_.find(resolution);
  if (found == resolutions_.end()) {
    Built built = build_model(bunny_mesh(), {.resolution = resolution, .target_points = 1000},
                              settings_.build_limit);
    found = resolutions_.emplace(resolution, std::move(built)).first;
  }
  return found->second;
}

Vec3 Bodies::bunny_core() {
  if (!core_) {
    constexpr int kSteps = 32;  // of each finer grid about the deepest place so far
    const Bounds& bounds = bunny().bounds();
    Vec3 core = bounds.center();
    Vec3 extents = bounds.extents();
    const auto search = [&](const auto& field) {
      for (int pass = 0; pass < 3; ++pass) {
        const Vec3 lower = core - 0.5 * extents;
        float least = field.distance(static_cast<Vec3f>(core));
        for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
          const Vec3 p = lower + Vec3{(i % kSteps + 0.5) / kSteps * extents.x,
                                      (i / kSteps % kSteps + 0.5) / kSteps * extents.y,
                                      (i / kSteps / kSteps + 0.5) / kSteps * extents.z};
          const float distance = field.distance(static_cast<Vec3f>(p));
          if (distance < least) {
            least = distance;
            core = p;
          }
        }
        extents = 0.125 * extents;
      }
    };
    std::visit(search, bunny().field());
    core_ = core;
  }
  return *core_;
}

}  // namespace voxshell::benchmarks
