#include "voxshell/bullet/debug_draw.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::debug_draw_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

/// Writes down what it is asked to draw.
class Recorder : public btIDebugDraw {
 public:
  struct Line {
    Vec3 from;
    Vec3 to;
    Vec3 color;
  };
  struct Ball {
    Vec3 center;
    double radius;
    Vec3 color;
  };

  using btIDebugDraw::drawLine;
  using btIDebugDraw::drawSphere;
  void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override {
    lines.push_back({from_bullet(from), from_bullet(to), from_bullet(color)});
  }
  void drawSphere(const btVector3& center, btScalar radius, const btVector3& color) override {
    balls.push_back({from_bullet(center), static_cast<double>(radius), from_bullet(color)});
  }
  void drawContactPoint(const btVector3& point, const btVector3&, btScalar, int,
                        const btVector3&) override {
    contacts.push_back(from_bullet(point));
  }
  void reportErrorWarning(const char*) override { ADD_FAILURE(); }
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int mode) override { mode_ = mode; }
  int getDebugMode() const override { return mode_; }

  std::vector<Line> lines;
  std::vector<Ball> balls;
  std::vector<Vec3> contacts;

 private:
  int mode_ = DBG_DrawWireframe | DBG_DrawContactPoints;
};

using Color = std::tuple<double, double, double>;
Color as_key(const Vec3& color) { return {color.x, color.y, color.z}; }

/// A blob somewhere in the world.
struct Scene {
  Pose body_from_model = Random(61).pose(0.2);
  Pose world_from_body = Random(62).pose(1.0);
  ModelShape shape{blob_model(), body_from_model};
  btTransform transform = to_bullet(world_from_body);
  Pose world_from_model = world_from_body * body_from_model;
  Recorder recorder;
};

constexpr double kRounding = 1e-5;

TEST(DebugDraw, PointsAreLinesOutwardsInTheColorsOfTheirSegments) {
  const PointShell& shell = blob_model()->shell();
  for (const int level : {1, 3, 4}) {
    Scene scene;
    draw_points(scene.recorder, scene.shape, scene.transform, {.level = level, .length = 0.01});
    ASSERT_EQ(scene.recorder.lines.size(), shell.size());
    std::map<std::uint32_t, Color> color_of;
    for (std::size_t i = 0; i < shell.size(); ++i) {
      const Recorder::Line& line = scene.recorder.lines[i];
      const auto point = static_cast<Vec3>(shell.points()[i]);
      const auto normal = static_cast<Vec3>(shell.normals()[i]);
      EXPECT_LT(length(line.from - scene.world_from_model.transform_point(point)), kRounding);
      EXPECT_LT(length(line.to - line.from - 0.01 * scene.world_from_model.rotate(normal)),
                kRounding);
      const std::uint32_t segment = shell.tree().segment(static_cast<std::uint32_t>(i), level);
      EXPECT_EQ(color_of.try_emplace(segment, as_key(line.color)).first->second,
                as_key(line.color));
    }
    std::set<Color> colors;
    for (const auto& [segment, color] : color_of) colors.insert(color);
    EXPECT_EQ(colors.size(), color_of.size());
    EXPECT_EQ(color_of.size(), PointSphereTree::cluster_count(level));
  }
}

TEST(DebugDraw, OfManyPointsAreEvenlyChosen) {
  const PointShell& shell = blob_model()->shell();
  ASSERT_GT(shell.size(), 500u);
  Scene scene;
  draw_points(scene.recorder, scene.shape, scene.transform, {.level = 3, .most_points = 300});
  ASSERT_EQ(scene.recorder.lines.size(), 300u);
  std::map<Color, int> points_of;
  for (const Recorder::Line& line : scene.recorder.lines) {
    ++points_of[as_key(line.color)];
    EXPECT_NEAR(length(line.to - line.from), shell.spacing(), kRounding);
  }
  EXPECT_EQ(points_of.size(), 16u);
  for (const auto& [color, count] : points_of) EXPECT_NEAR(count, 300.0 / 16.0, 3.0);
}

TEST(DebugDraw, SpheresOfALevelHoldTheirSegmentsPoints) {
  const PointShell& shell = blob_model()->shell();
  for (const int level : {1, 2, 4}) {
    Scene scene;
    draw_spheres(scene.recorder, scene.shape, scene.transform, level);
    ASSERT_EQ(scene.recorder.balls.size(), PointSphereTree::cluster_count(level));
    for (std::size_t i = 0; i < shell.size(); ++i) {
      const Recorder::Ball& ball =
          scene.recorder.balls[shell.tree().segment(static_cast<std::uint32_t>(i), level)];
      const Vec3 point =
          scene.world_from_model.transform_point(static_cast<Vec3>(shell.points()[i]));
      EXPECT_LE(length(point - ball.center), ball.radius + kRounding);
    }
  }
}

TEST(DebugDraw, LevelsBeyondTheTreesAreTheLast) {
  const int last = blob_model()->shell().tree().level_count();
  for (const int level : {-1, 0, last, 40}) {
    Scene scene;
    draw_spheres(scene.recorder, scene.shape, scene.transform, level);
    EXPECT_EQ(scene.recorder.balls.size(), PointSphereTree::cluster_count(level < 1 ? 1 : last));
    draw_points(scene.recorder, scene.shape, scene.transform, {.level = level});
    EXPECT_EQ(scene.recorder.lines.size(), blob_model()->shell().size());
  }
}

TEST(DebugDraw, NeighboringSegmentsDiffer) {
  for (std::uint32_t i = 0; i < 256; ++i) {
    const btVector3 color = segment_color(i);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(color[k], 0);
      EXPECT_LE(color[k], 1);
    }
    EXPECT_EQ(std::max({color.x(), color.y(), color.z()}), btScalar(1));
    EXPECT_GT((color - segment_color(i + 1)).length(), scalar(0.5)) << i;
  }
}

TEST(DebugDraw, TheWorldsOwnShowsTheMeshAndItsContacts) {
  TestWorld world;
  world.add_model(slab_model(), 0);
  btRigidBody& blob = world.add_model(blob_model(), 1, {Random(63).rotation(), {0.05, 0, 0.08}});
  world.step(2);
  Recorder recorder;
  world.world.setDebugDrawer(&recorder);
  world.world.debugDrawWorld();
  world.world.setDebugDrawer(nullptr);
  const std::size_t triangles =
      slab_model()->mesh().triangles().size() + blob_model()->mesh().triangles().size();
  EXPECT_GE(recorder.lines.size(), 3 * triangles);
  EXPECT_LT(recorder.lines.size(), 4 * triangles + 100);
  // Each of the blob's vertices is somewhere an end of a line.
  std::size_t drawn = 0;
  const Pose pose = from_bullet(blob.getWorldTransform());
  for (const Vec3& vertex : blob_model()->mesh().vertices()) {
    const Vec3 place = pose.transform_point(vertex);
    drawn += std::any_of(recorder.lines.begin(), recorder.lines.end(),
                         [&](const auto& line) { return length(line.from - place) < kRounding; });
  }
  EXPECT_EQ(drawn, blob_model()->mesh().vertices().size());
  EXPECT_FALSE(recorder.contacts.empty());
  EXPECT_EQ(recorder.contacts.size(), world.points().size());
}

}  // namespace
}  // namespace voxshell::bullet::debug_draw_test
