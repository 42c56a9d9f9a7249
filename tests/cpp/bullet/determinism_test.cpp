#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;

/// FNV-1a over the bits of numbers.
class Hash {
 public:
  template <class Number>
  void add(Number value) {
    std::array<unsigned char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), &value, bytes.size());
    for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3u;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

enum class Scene { kPileRegular, kPileSegmented, kTerrain, kThrows, kCompounds };

/// Makes a scene, moved sideways by `nudge`, and hashes all transforms after each of `steps` steps.
std::uint64_t hash_of(Scene scene, double nudge, int steps) {
  static const std::vector<float> heights = [] {
    std::vector<float> all;
    for (int i = 0; i < 81; ++i) all.push_back(0.01f * static_cast<float>((i * 37) % 7));
    return all;
  }();
  TestWorld world(
      {.mode = scene == Scene::kPileRegular ? ContactMode::kRegular : ContactMode::kSegmented});
  if (scene == Scene::kTerrain) {
    auto& terrain = world.make<btHeightfieldTerrainShape>(9, 9, heights.data(), btScalar(0),
                                                          btScalar(0.1), 2, false);
    terrain.setLocalScaling(to_bullet(Vec3{0.1, 0.1, 1.0}));
    world.add(terrain, 0, {{}, {0, 0, 0.05}}).setFriction(1);
  } else {
    world.add_model(slab_model(), 0).setFriction(1);
  }
  const std::shared_ptr<const Model> models[] = {cube_model(), blob_model(), torus_model(),
                                                 ball_model(), blob_model()};
  std::vector<const btRigidBody*> bodies;
  for (int i = 0; i < 5; ++i) {
    btCollisionShape* shape = &world.make<ModelShape>(models[i]);
    if (scene == Scene::kCompounds) {
      auto& compound = world.make<btCompoundShape>();
      compound.addChildShape(to_bullet(Pose{{}, {0.05, 0, 0}}), shape);
      compound.addChildShape(to_bullet(Pose{{}, {-0.05, 0, 0}}),
                             &world.make<btSphereShape>(scalar(0.08)));
      shape = &compound;
    }
    btRigidBody& body =
        world.add(*shape, 1 + i, {{}, {0.03 * i + nudge, 0.02 * (i % 2), 0.15 + 0.25 * i}});
    body.setFriction(scalar(0.5));
    body.setRestitution(scalar(0.3));
    if (scene == Scene::kThrows) body.setLinearVelocity(to_bullet(Vec3{0.5, 0, -10.0 * i}));
    bodies.push_back(&body);
  }
  Hash hash;
  for (int i = 0; i < steps; ++i) {
    world.step(1);
    for (const btRigidBody* body : bodies) {
      const btTransform& t = body->getWorldTransform();
      for (int k = 0; k < 12; ++k) {
        hash.add(k < 3 ? t.getOrigin()[k] : t.getBasis()[k / 3 - 1][k % 3]);
      }
    }
  }
  return hash.value();
}

TEST(Determinism, ScenesFallTheSameWayOnEveryRun) {
  constexpr int kSteps = 1000;
  for (const Scene scene : {Scene::kPileRegular, Scene::kPileSegmented, Scene::kTerrain,
                            Scene::kThrows, Scene::kCompounds}) {
    EXPECT_EQ(hash_of(scene, 0.0, kSteps), hash_of(scene, 0.0, kSteps))
        << "scene " << static_cast<int>(scene);
  }
}

TEST(Determinism, TheHashSeesThePoses) {
  EXPECT_NE(hash_of(Scene::kPileSegmented, 0.0, 50), hash_of(Scene::kPileSegmented, 1e-5, 50));
}

}  // namespace
}  // namespace voxshell::bullet
