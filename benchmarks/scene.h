#pragma once

#include <benchmark/benchmark.h>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bodies.h"
#include "query_timer.h"
#include "voxshell/contacts.h"

namespace voxshell::benchmarks {

/// A shell in a field, in many poses.
struct Scene {
  const Field* field = nullptr;
  const PointShell* shell = nullptr;
  std::vector<Pose> poses;  ///< field_from_shell
  std::string why_not;      ///< why there is no such scene, or that queries are wrong in it
};

/// A question, asked with a scratch; the number stands for the answer.
struct SceneQuery {
  const char* name;
  std::size_t (*ask)(const Scene&, const Pose&, QueryScratch&);
};

/// The flat loop, scalar, that all others are compared with; then the others.
std::span<const SceneQuery> scene_queries();
const SceneQuery& scene_query(std::string_view name);

/// A scene that is made once, when it is first asked for. Its queries are held to the flat loop:
/// where one differs by a bit, the scene says so and is not timed.
class LazyScene {
 public:
  explicit LazyScene(std::function<Scene()> make) : make_(std::move(make)) {}

  const Scene& get();

 private:
  std::function<Scene()> make_;
  std::optional<Scene> scene_;
};

/// One case: `scene/query/visit`.
void register_query(const std::string& scene_name, const std::shared_ptr<LazyScene>& scene,
                    const SceneQuery& query, Visit visit, const Settings& settings);

}  // namespace voxshell::benchmarks
