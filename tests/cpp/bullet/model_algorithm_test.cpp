#include "model_algorithm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <vector>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <gtest/gtest.h>

#include "contact_constants.h"
#include "support/brick.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"
#include "wrap_object.h"

namespace voxshell::bullet::model_algorithm_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kStep = 1.0 / 100.0;
constexpr double kTolerance = 2e-6;  // of single precision, meters
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Two bodies of a world, and the algorithm of their pair, which nobody else calls.
class Pair {
 public:
  Pair(TestWorld& world, const btRigidBody& a, const btRigidBody& b,
       const ContactSettings& settings = {}, Purpose purpose = Purpose::kSimulation)
      : settings_(settings),
        dispatcher_(world.dispatcher),
        wrap_a_(wrap_object(a)),
        wrap_b_(wrap_object(b)),
        algorithm_({&world.dispatcher, 0}, settings_, purpose, nullptr) {
    info_.m_timeStep = scalar(kStep);
  }

  void prepare() { algorithm_.prepare(wrap_a_, wrap_b_, kStep, nullptr); }
  void process(btManifoldResult& result) {
    algorithm_.processCollision(&wrap_a_, &wrap_b_, info_, &result);
  }
  /// A step, and the points that it leaves in manifolds.
  std::vector<const btManifoldPoint*> step() {
    btManifoldResult result(&wrap_a_, &wrap_b_);
    process(result);
    return points();
  }
  std::vector<const btManifoldPoint*> points() {
    btManifoldArray manifolds;
    algorithm_.getAllContactManifolds(manifolds);
    EXPECT_EQ(manifolds.size(), dispatcher_.getNumManifolds());
    std::vector<const btManifoldPoint*> all;
    for (int m = 0; m < manifolds.size(); ++m) {
      EXPECT_EQ(manifolds[m]->getBody0(), wrap_a_.getCollisionObject());
      EXPECT_EQ(manifolds[m]->getBody1(), wrap_b_.getCollisionObject());
      for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
        all.push_back(&manifolds[m]->getContactPoint(i));
      }
    }
    return all;
  }
  const btCollisionObjectWrapper& wrap_a() const { return wrap_a_; }
  const btCollisionObjectWrapper& wrap_b() const { return wrap_b_; }
  ModelAlgorithm& algorithm() { return algorithm_; }

 private:
  ContactSettings settings_;
  btCollisionDispatcher& dispatcher_;
  btDispatcherInfo info_;
  btCollisionObjectWrapper wrap_a_;
  btCollisionObjectWrapper wrap_b_;
  ModelAlgorithm algorithm_;
};

btRigidBody& add_plane(TestWorld& world) {
  return world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
}

void put(btRigidBody& body, const Pose& pose) { body.setWorldTransform(to_bullet(pose)); }

/// All of the points are that far from the surface.
void expect_distance(const std::vector<const btManifoldPoint*>& points, double distance,
                     double tolerance = kTolerance) {
  EXPECT_FALSE(points.empty());
  for (const btManifoldPoint* point : points) {
    EXPECT_NEAR(point->getDistance(), distance, tolerance);
  }
}

std::set<int> ids_of(const std::vector<const btManifoldPoint*>& points) {
  std::set<int> ids;
  for (const btManifoldPoint* point : points) ids.insert(point->m_index0);
  return ids;
}

double nearest_of(const std::vector<const btManifoldPoint*>& points) {
  double least = kInfinity;
  for (const btManifoldPoint* point : points) {
    least = std::min(least, static_cast<double>(point->getDistance()));
  }
  return least;
}

TEST(ModelAlgorithm, HasManifoldsWhileTheBodiesTouch) {
  for (const bool cube_first : {true, false}) {
    TestWorld world({}, {});
    btRigidBody& cube = world.add_model(cube_model(), 1);
    btRigidBody& ground =
        world.add(world.make<btBoxShape>(btVector3(1, 1, 1)), 0, {{}, {0, 0, -1}});
    {
      Pair pair(world, cube_first ? cube : ground, cube_first ? ground : cube);
      const auto at = [&](double height) {
        put(cube, {{}, {0, 0, kCubeHalf + height}});
        return pair.step();
      };
      const auto touching = at(-0.004);
      expect_distance(touching, -0.004);
      for (const btManifoldPoint* point : touching) {
        EXPECT_NEAR(point->m_normalWorldOnB.z(), cube_first ? 1.0 : -1.0, kTolerance);
      }
      EXPECT_TRUE(pair.algorithm().is_near());
      EXPECT_TRUE(at(0.001).empty());  // three times the rest margin
      EXPECT_FALSE(pair.algorithm().is_near());
      expect_distance(at(-0.002), -0.002);
      EXPECT_GT(world.dispatcher.getNumManifolds(), 0);
    }
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
  }
}

TEST(ModelAlgorithm, PutsIntoManifoldsWhatWasPrepared) {
  TestWorld world({}, {});
  btRigidBody& cube = world.add_model(cube_model(), 1);
  Pair pair(world, cube, add_plane(world));
  const auto sink = [&](double depth) { put(cube, {{}, {0, 0, kCubeHalf - depth}}); };
  sink(0.004);
  pair.prepare();
  sink(0.009);
  expect_distance(pair.step(), -0.004);
  expect_distance(pair.step(), -0.009);
  sink(0.006);
  pair.prepare();
  sink(0.002);
  pair.algorithm().drop_prepared();
  expect_distance(pair.step(), -0.002);
}

TEST(ModelAlgorithm, SearchesOnlyOnceTheBodiesHaveMoved) {
  constexpr double kMargin = 1e-3;
  const ContactSettings automatic{.margin = kMargin};
  const ContactSettings fewest{.shell = ShellRule::kFewest, .margin = kMargin};
  const ContactSettings segmented{.mode = ContactMode::kSegmented, .margin = kMargin};
  for (const ContactSettings& settings : {automatic, fewest, segmented}) {
    // A point of each segment is what segments promise, so these always search.
    const bool keeps = settings.mode == ContactMode::kAutomatic;
    TestWorld world({}, {});
    btRigidBody& brick = world.add_model(brick_model(), 1);
    Pair pair(world, brick, add_plane(world), settings);
    double depth = 0.001;
    for (const auto& [sinks, searches] :
         {std::pair(0.0, true), std::pair(0.0, !keeps), std::pair(0.09 * kMargin, !keeps),
          std::pair(0.02 * kMargin, true), std::pair(0.09 * kMargin, !keeps)}) {
      depth += sinks;
      put(brick, {{}, {0, 0, kBrickHalf.z - depth}});
      expect_distance(pair.step(), -depth);
      EXPECT_EQ(pair.algorithm().has_searched(), searches) << depth;
    }
  }
}

/// Collects the distances that a contact test reports.
class Reported : public btManifoldResult {
 public:
  explicit Reported(const Pair& pair, double threshold)
      : btManifoldResult(&pair.wrap_a(), &pair.wrap_b()) {
    m_closestPointDistanceThreshold = scalar(threshold);
  }
  void addContactPoint(const btVector3& normal, const btVector3& on_b, btScalar distance) override {
    EXPECT_NEAR(normal.z(), 1.0, kTolerance);
    EXPECT_NEAR(on_b.z(), 0.0, kTolerance);
    distances.push_back(static_cast<double>(distance));
  }
  std::vector<double> distances;
};

TEST(ModelAlgorithm, TellsContactTestsAtOnceAndKeepsNothing) {
  constexpr double kGap = 0.01;
  // Bullet asks the algorithms of a simulation, too, for the children of compounds.
  for (const Purpose purpose : {Purpose::kContactTest, Purpose::kSimulation}) {
    TestWorld world({}, {});
    btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + kGap}});
    cube.setLinearVelocity(btVector3(0, 0, -50));  // which says nothing about where it is
    Pair pair(world, cube, add_plane(world), {}, purpose);
    Reported within(pair, 1.1 * kGap);
    pair.process(within);
    ASSERT_EQ(within.distances.size(), kManifoldSize);
    for (const double distance : within.distances) EXPECT_NEAR(distance, kGap, kTolerance);
    Reported beyond(pair, 0.9 * kGap);
    pair.process(beyond);
    EXPECT_TRUE(beyond.distances.empty());
    EXPECT_TRUE(pair.points().empty());
    // With Bullet's own result, it depends on who asks.
    EXPECT_EQ(pair.step().empty(), purpose == Purpose::kContactTest);
  }
}

TEST(ModelAlgorithm, LooksAheadAsFarAsTheBodiesMove) {
  constexpr double kSpeed = 20.0;  // m/s, 0.2 m a step
  TestWorld world({}, {});
  btTriangleMesh triangles;
  triangles.addTriangle({-2, -2, 0}, {2, -2, 0}, {0, 3, 0});
  auto& mesh_shape = world.make<btBvhTriangleMeshShape>(&triangles, true);
  mesh_shape.setMargin(0);
  btRigidBody& mesh = world.add(mesh_shape, 0);
  btRigidBody& box = world.add(world.make<btBoxShape>(btVector3(1, 1, 1)), 0, {{}, {0, 0, -1}});
  for (btRigidBody* ground : {&add_plane(world), &mesh, &box}) {
    SCOPED_TRACE(ground->getCollisionShape()->getName());
    for (const double gap : {0.15, 0.25}) {
      btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + gap}});
      cube.setLinearVelocity(btVector3(0, 0, scalar(-kSpeed)));
      Pair pair(world, cube, *ground);
      const auto points = pair.step();
      if (gap > kSpeed * kStep) {
        EXPECT_TRUE(points.empty());
      } else {
        EXPECT_NEAR(nearest_of(points), gap, 1e-4);
      }
    }
  }
}

/// Whose deepest one stays the deepest, though others now span a larger area; but not where another
/// one is deeper by more than a quarter of the rest margin.
TEST(ModelAlgorithm, KeepsPointsThatAreDeepEnough) {
  constexpr double kMargin = 2e-3;
  const double band = static_cast<double>(kKeepsPointsOfMargin) * kMargin;
  const ContactSettings settings{.mode = ContactMode::kRegular,
                                 .shell = ShellRule::kFewest,
                                 .margin = kMargin,
                                 .ccd_motion_threshold = kInfinity};
  Random random(8);
  int kept = 0;
  int changed = 0;
  for (int i = 0; i < 40; ++i) {
    TestWorld world({}, {});
    btRigidBody& blob = world.add_model(blob_model(), 1);
    Pair pair(world, blob, add_plane(world), settings);
    const Pose start{random.rotation(), {0, 0, random.uniform(0.07, 0.085)}};
    const auto chosen_anew = [&](const Pose& pose) {
      TestWorld alone({}, {});
      btRigidBody& again = alone.add_model(blob_model(), 1, pose);
      Pair fresh(alone, again, add_plane(alone), settings);
      const auto points = fresh.step();
      return std::pair(ids_of(points), nearest_of(points));
    };
    put(blob, start);
    const std::set<int> ids = ids_of(pair.step());
    if (ids.size() < kManifoldSize) continue;
    const Pose sunk{start.rotation, start.translation - Vec3{0, 0, 2e-3}};
    put(blob, sunk);
    EXPECT_EQ(ids_of(pair.step()), ids) << i;
    kept += chosen_anew(sunk).first != ids;
    constexpr double kAngle = 0.2;
    const Matrix3 about_x{{1, 0, 0},
                          {0, std::cos(kAngle), -std::sin(kAngle)},
                          {0, std::sin(kAngle), std::cos(kAngle)}};
    const Pose turned{about_x * start.rotation, sunk.translation};
    put(blob, turned);
    const auto after = pair.step();
    EXPECT_LE(nearest_of(after), chosen_anew(turned).second + band + kTolerance) << i;
    changed += ids_of(after) != ids;
  }
  EXPECT_GT(kept, 10);
  EXPECT_GT(changed, 10);
}

TEST(ModelAlgorithm, LeavesOutPointsTooHighAboveTheNearestToCarry) {
  constexpr double kMargin = 2e-3;
  TestWorld world({}, {});
  const double angle = 0.75 * kMargin / (2 * kCubeHalf);
  const Pose tilted{
      {{std::cos(angle), 0, std::sin(angle)}, {0, 1, 0}, {-std::sin(angle), 0, std::cos(angle)}},
      {}};
  const double lowest = tilted.transform_point({kCubeHalf, 0, -kCubeHalf}).z;
  btRigidBody& cube = world.add_model(cube_model(), 1, {tilted.rotation, {0, 0, -lowest}});
  cube.setLinearVelocity(btVector3(scalar(0.05), 0, 0));
  Pair pair(world, cube, add_plane(world), {.mode = ContactMode::kRegular, .margin = kMargin});
  const auto points = pair.step();
  EXPECT_GE(points.size(), 3u);
  double highest = 0.0;
  for (const btManifoldPoint* point : points) {
    highest = std::max(highest, static_cast<double>(point->getDistance()));
  }
  const double band = static_cast<double>(kIdleOfMargin) * kMargin;
  EXPECT_LE(highest, band + kTolerance);
  // Those that are left span what they can: points are 10 mm apart.
  EXPECT_GT(highest, band - 0.011 * angle);
}

}  // namespace
}  // namespace voxshell::bullet::model_algorithm_test
