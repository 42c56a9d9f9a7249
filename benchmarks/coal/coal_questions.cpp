#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <memory>
#include <utility>

#include "question.h"

namespace voxshell::benchmarks {
namespace {

using Transforms = std::vector<coal::Transform3s>;

template <class Volume>
std::shared_ptr<const coal::CollisionGeometry> build_tree(const TriangleMesh& mesh) {
  std::vector<coal::Vec3s> vertices;
  for (const Vec3& v : mesh.vertices()) vertices.emplace_back(v.x, v.y, v.z);
  std::vector<coal::Triangle> triangles;
  for (const Triangle& t : mesh.triangles()) triangles.emplace_back(t[0], t[1], t[2]);
  auto tree = std::make_shared<coal::BVHModel<Volume>>();
  tree->beginModel(static_cast<unsigned>(triangles.size()), static_cast<unsigned>(vertices.size()));
  tree->addSubModel(vertices, triangles);
  tree->endModel();
  return tree;
}

coal::Transform3s to_coal(const Pose& pose) {
  coal::Matrix3s rotation;
  const Matrix3& m = pose.rotation;
  rotation << m.row_x.x, m.row_x.y, m.row_x.z, m.row_y.x, m.row_y.y, m.row_y.z, m.row_z.x,
      m.row_z.y, m.row_z.z;
  return {rotation, coal::Vec3s(pose.translation.x, pose.translation.y, pose.translation.z)};
}

/// One contact, of which nothing is computed.
coal::CollisionRequest yes_or_no() { return {coal::NO_REQUEST, 1}; }

/// What only contacts and distances need is left out as well: volumes less than `break_distance`
/// apart (1 mm unless set) count as disjoint, and triangles are known to be once a plane parts
/// them.
coal::CollisionRequest quickest_yes_or_no() {
  coal::CollisionRequest request = yes_or_no();
  request.break_distance = 0.0;
  request.distance_upper_bound = 0.0;
  return request;
}

}  // namespace

std::vector<Question> make_coal_questions(const TriangleMesh& mesh,
                                          std::span<const Pose> world_from_a) {
  const auto made = std::make_shared<Transforms>();
  for (const Pose& pose : world_from_a) made->push_back(to_coal(pose));
  const std::shared_ptr<const Transforms> transforms = made;
  const coal::Transform3s identity = coal::Transform3s::Identity();
  const auto obbrss = build_tree<coal::OBBRSS>(mesh);

  std::vector<Question> questions;
  const auto add = [&](const char* name, std::shared_ptr<const coal::CollisionGeometry> tree,
                       const coal::CollisionRequest& request) {
    const auto ask = [=, result = coal::CollisionResult()](std::size_t pose) mutable {
      result.clear();
      return coal::collide(tree.get(), (*transforms)[pose], tree.get(), identity, request, result) >
             0;
    };
    questions.push_back({name, ask});
  };
  add("OBBRSS", obbrss, quickest_yes_or_no());
  add("OBB", build_tree<coal::OBB>(mesh), quickest_yes_or_no());
  add("kIOS", build_tree<coal::kIOS>(mesh), quickest_yes_or_no());
  // Looks up what suits the two geometries once, not at every call.
  const auto chosen = std::make_shared<coal::ComputeCollision>(obbrss.get(), obbrss.get());
  questions.push_back(
      {"OBBRSS, made ready", [=, request = quickest_yes_or_no(),
                              result = coal::CollisionResult()](std::size_t pose) mutable {
         result.clear();
         return (*chosen)((*transforms)[pose], identity, request, result) > 0;
       }});
  add("as it comes", obbrss, yes_or_no());
  return questions;
}

}  // namespace voxshell::benchmarks
