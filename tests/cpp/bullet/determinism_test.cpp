#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <vector>
#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <LinearMath/btScalar.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/carried_contacts.h"
#include "voxshell/bullet/checked_motion.h"
#include "voxshell/bullet/coulomb_solver.h"
#include "voxshell/bullet/force_aware_world.h"
#include "voxshell/bullet/kinematic_motion_world.h"
#include "voxshell/bullet/momentum_world.h"
#include "voxshell/bullet/seamless_world.h"
#include "voxshell/bullet/sleepy_world.h"
#include "voxshell/bullet/taut_joints.h"

namespace voxshell::bullet::determinism_test {
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

enum class Scene { kPileRegular, kPileSegmented, kTerrain, kThrows, kCompounds, kDefaults };

/// Makes a scene in an empty world, moved sideways by `nudge`, and hashes all transforms after each
/// of `steps` steps.
template <class World>
std::uint64_t hash_in(World& world, Scene scene, double nudge, int steps) {
  static const std::vector<float> heights = [] {
    std::vector<float> all;
    for (int i = 0; i < 81; ++i) all.push_back(0.01f * static_cast<float>((i * 37) % 7));
    return all;
  }();
  if (scene == Scene::kTerrain) {
    auto& terrain = world.template make<btHeightfieldTerrainShape>(
        9, 9, heights.data(), btScalar(0), btScalar(0.1), 2, false);
    terrain.setLocalScaling(to_bullet(Vec3{0.1, 0.1, 1.0}));
    world.add(terrain, 0, {{}, {0, 0, 0.05}}).setFriction(1);
  } else {
    world.add_model(slab_model(), 0).setFriction(1);
  }
  const std::shared_ptr<const Model> models[] = {cube_model(), blob_model(), torus_model(),
                                                 ball_model(), blob_model()};
  std::vector<const btRigidBody*> bodies;
  for (int i = 0; i < 5; ++i) {
    btCollisionShape* shape = &world.template make<ModelShape>(models[i]);
    if (scene == Scene::kCompounds) {
      auto& compound = world.template make<btCompoundShape>();
      compound.addChildShape(to_bullet(Pose{{}, {0.05, 0, 0}}), shape);
      compound.addChildShape(to_bullet(Pose{{}, {-0.05, 0, 0}}),
                             &world.template make<btSphereShape>(scalar(0.08)));
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

/// In the stock world, with the stock solver.
std::uint64_t hash_of(Scene scene, double nudge, int steps) {
  ContactSettings settings;
  if (scene != Scene::kDefaults) {
    settings.mode = scene == Scene::kPileRegular ? ContactMode::kRegular : ContactMode::kSegmented;
  }
  TestWorld world(settings);
  return hash_in(world, scene, nudge, steps);
}

/// In a world and with a solver like those of Python's World.
std::uint64_t hash_of_python(int steps) {
  using World = SleepyWorld<TautJointsWorld<CheckedMotionWorld<MomentumWorld<
      ForceAwareWorld<SeamlessWorld<CarriedContactsWorld<KinematicMotionWorld<>>>>>>>>;
  WorldOf<World, CoulombSolver> world;
  btContactSolverInfo& info = world.world.getSolverInfo();
  info.m_minimumSolverBatchSize = 1;
  info.m_solverMode |=
      SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  return hash_in(world, Scene::kDefaults, 0.0, steps);
}

constexpr Scene kScenes[] = {Scene::kPileRegular, Scene::kPileSegmented, Scene::kTerrain,
                             Scene::kThrows,      Scene::kCompounds,     Scene::kDefaults};
constexpr int kSteps = 1000;

/// What the bits depend on beside this project: Bullet, its precision, and sines and cosines.
std::string platform() {
  std::string name =
      "Bullet " + std::to_string(btGetVersion()) + (kIsDouble ? " double" : " float");
#ifdef VOXSHELL_PORTABLE_FUNCTIONS
  return name + ", anywhere";
#endif
#ifdef __GLIBC__
  name += std::string(", glibc ") + gnu_get_libc_version();
#endif
#ifdef __x86_64__
  name += __builtin_cpu_supports("fma") ? ", x86-64 with FMA" : ", x86-64";
#endif
  return name;
}

/// Of the scenes, as they were when the contact rule was last changed on purpose.
const std::map<std::string, std::array<std::uint64_t, std::size(kScenes)>>& golden_hashes() {
  static const std::map<std::string, std::array<std::uint64_t, std::size(kScenes)>> hashes{
      {"Bullet 324 float, glibc 2.36, x86-64 with FMA",
       {0x9b1af2a6945689bf, 0xa135d89f8f438286, 0x08762f4bb24ea561, 0xf3ce01eff0f16538,
        0xa310c6089d549668, 0xedb3dc8a4527cc06}},
      {"Bullet 324 double, anywhere",
       {0x520b298901442e54, 0x7f0186f65f06013a, 0x74b47e342d6c8bd0, 0xc5856af0a4ecd9f6,
        0x07a1816247ba4382, 0xda61ed58929fe25e}},
      {"Bullet 324 double, glibc 2.36, x86-64 with FMA",
       {0x35e6362927aaa056, 0x344170e8e5b0e7f4, 0x4198862f13847007, 0xdaf81919195a893c,
        0x8610aec1f68e2e95, 0x75583eb10b9fa227}},
  };
  return hashes;
}

TEST(Determinism, ScenesFallTheSameWayOnEveryRun) {
  std::array<std::uint64_t, std::size(kScenes)> hashes{};
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    hashes[i] = hash_of(kScenes[i], 0.0, kSteps);
    EXPECT_EQ(hashes[i], hash_of(kScenes[i], 0.0, kSteps)) << "scene " << i;
    EXPECT_EQ(hashes[i], hash_of(kScenes[i], 0.0, kSteps)) << "scene " << i;
  }
  const auto golden = golden_hashes().find(platform());
  if (golden == golden_hashes().end()) {
    std::cout << "no hashes are kept for " << platform() << ':' << std::hex;
    for (const std::uint64_t hash : hashes) std::cout << " 0x" << hash;
    std::cout << '\n';
    return;
  }
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    EXPECT_EQ(hashes[i], golden->second[i])
        << "scene " << i << " no longer falls as it did: if that is meant, keep 0x" << std::hex
        << hashes[i] << " for " << platform();
  }
}

// Compilers for different processors evaluated the arguments of a call in different orders, and
// with them set the two rows of a point's friction.
TEST(Determinism, FrictionInTwoDirectionsIsSolvedInTheSameOrderOnEveryProcessor) {
  const std::uint64_t hash = hash_of_python(kSteps);
  EXPECT_EQ(hash, hash_of_python(kSteps));
  if (platform() == "Bullet 324 double, anywhere") {
    EXPECT_EQ(hash, 0x9958185d095f5899u);
  }
}

TEST(Determinism, TheHashSeesThePoses) {
  EXPECT_NE(hash_of(Scene::kPileSegmented, 0.0, 50), hash_of(Scene::kPileSegmented, 1e-5, 50));
}

}  // namespace
}  // namespace voxshell::bullet::determinism_test
