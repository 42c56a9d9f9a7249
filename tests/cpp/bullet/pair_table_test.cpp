#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btMultimaterialTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btSdfCollisionShape.h>
#include <BulletCollision/CollisionShapes/btTetrahedronShape.h>
#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <gtest/gtest.h>
#ifdef __SANITIZE_ADDRESS__
#include <optional>
#include <sanitizer/lsan_interface.h>
#endif

#include "support/deepest_result.h"
#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::pair_table_test {
namespace {

using namespace test_support;

constexpr double kDepth = 0.004;  ///< meters, of a cube in its partner
constexpr double kMargin = 0.001;

/// A mesh of Bullet's: a square of 2 x 2 m whose top is at z = 0, in 8 triangles.
struct FlatMesh {
  std::vector<btScalar> vertices;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> array;

  explicit FlatMesh(double scale = 1.0) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        vertices.insert(vertices.end(), {scalar(scale * (i - 1)), scalar(scale * (j - 1)), 0});
      }
    }
    for (const int corner : {0, 1, 3, 4}) {
      indices.insert(indices.end(), {corner, corner + 1, corner + 4});
      indices.insert(indices.end(), {corner, corner + 4, corner + 3});
    }
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(indices.size() / 3), indices.data(), 3 * sizeof(int),
        static_cast<int>(vertices.size() / 3), vertices.data(), 3 * sizeof(btScalar));
  }
};

btTriangleIndexVertexArray* flat_mesh() {
  static FlatMesh mesh;
  return mesh.array.get();
}

/// A box of 0.6 x 0.6 x 0.2 m.
btTriangleMesh* box_mesh() {
  static const auto mesh = [] {
    auto triangles = std::make_unique<btTriangleMesh>();
    const auto box = voxshell::test_support::make_box({0.3, 0.3, 0.1});
    for (const auto& [a, b, c] : box.triangles) {
      triangles->addTriangle(to_bullet(box.vertices[a]), to_bullet(box.vertices[b]),
                             to_bullet(box.vertices[c]));
    }
    return triangles;
  }();
  return mesh.get();
}

/// Every tenth of whose size is that of flat_mesh().
btTriangleIndexVertexArray* large_flat_mesh() {
  static FlatMesh mesh(10.0);
  return mesh.array.get();
}

template <class Shape>
Shape& with_margin(Shape& shape) {
  shape.setMargin(scalar(kMargin));
  return shape;
}

struct Partner {
  const char* shape;  ///< Bullet's name
  double top;         ///< of its highest place below the cube, along z
  std::function<btCollisionShape&(TestWorld&)> make;
};

const std::vector<Partner>& partners() {
  static const std::vector<float> heights(9, 0.0f);
  static const std::vector<Partner> all{
      {"voxshell ModelShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& { return w.make<ModelShape>(slab_model()); }},
      {"btBoxShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btBoxShape>(to_bullet(Vec3{0.3, 0.3, 0.1}));
       }},
      {"btSphereShape", 0.3,
       [](TestWorld& w) -> btCollisionShape& { return w.make<btSphereShape>(scalar(0.3)); }},
      {"btCapsuleShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCapsuleShapeX>(scalar(0.1), scalar(0.3));
       }},
      {"btCylinderShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCylinderShapeZ>(to_bullet(Vec3{0.2, 0.2, 0.1}));
       }},
      {"btConeShape", 0.1 + kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         return with_margin(w.make<btConeShapeZ>(scalar(0.2), scalar(0.2)));
       }},
      {"btMultiSphereShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         const btVector3 centers[] = {to_bullet(Vec3{-0.1, 0, 0}), to_bullet(Vec3{0.1, 0, 0})};
         const btScalar radii[] = {scalar(0.1), scalar(0.1)};
         return w.make<btMultiSphereShape>(centers, radii, 2);
       }},
      {"btConvexHullShape", 0.1 + kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         auto& hull = w.make<btConvexHullShape>();
         for (const Vec3& v : voxshell::test_support::make_box({0.3, 0.3, 0.1}).vertices) {
           hull.addPoint(to_bullet(v));
         }
         return with_margin(hull);
       }},
      {"btConvexHullShape that is flat", kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         auto& flat = w.make<btConvexHullShape>();
         for (const double x : {-0.3, 0.3}) {
           for (const double y : {-0.3, 0.3}) flat.addPoint(to_bullet(Vec3{x, y, 0.0}));
         }
         return with_margin(flat);
       }},
      {"btConvexPointCloudShape", 0.1 + kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         static std::vector<btVector3> points;
         if (points.empty()) {
           for (const Vec3& v : voxshell::test_support::make_box({0.3, 0.3, 0.1}).vertices) {
             points.push_back(to_bullet(v));
           }
         }
         return with_margin(w.make<btConvexPointCloudShape>(
             points.data(), static_cast<int>(points.size()), btVector3(1, 1, 1)));
       }},
      {"btConvexTriangleMeshShape", 0.1 + kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         return with_margin(w.make<btConvexTriangleMeshShape>(box_mesh()));
       }},
      {"btBU_Simplex1to4", kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         return with_margin(
             w.make<btBU_Simplex1to4>(to_bullet(Vec3{-0.5, -0.4, 0}), to_bullet(Vec3{0.5, -0.4, 0}),
                                      to_bullet(Vec3{0, 0.5, 0}), to_bullet(Vec3{0, 0, -0.5})));
       }},
      {"btTriangleShape", kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         return with_margin(w.make<btTriangleShape>(to_bullet(Vec3{-0.5, -0.4, 0}),
                                                    to_bullet(Vec3{0.5, -0.4, 0}),
                                                    to_bullet(Vec3{0, 0.5, 0})));
       }},
      {"btUniformScalingShape", 0.15,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btUniformScalingShape>(&w.make<btSphereShape>(scalar(0.3)), scalar(0.5));
       }},
      {"btMinkowskiSumShape", 0.2,
       [](TestWorld& w) -> btCollisionShape& {
         auto& sum =
             w.make<btMinkowskiSumShape>(&w.make<btSphereShape>(scalar(0.1)),
                                         &w.make<btBoxShape>(to_bullet(Vec3{0.2, 0.2, 0.1})));
         return sum;
       }},
      {"btBox2dShape", kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         return with_margin(w.make<btBox2dShape>(to_bullet(Vec3{0.3, 0.3, 0.0})));
       }},
      {"btConvex2dShape", kMargin,
       [](TestWorld& w) -> btCollisionShape& {
         auto& flat = w.make<btConvexHullShape>();
         for (const double x : {-0.3, 0.3}) {
           for (const double y : {-0.3, 0.3}) flat.addPoint(to_bullet(Vec3{x, y, 0.0}));
         }
         flat.setMargin(scalar(kMargin));
         return w.make<btConvex2dShape>(&flat);
       }},
      {"btStaticPlaneShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
       }},
      {"btBvhTriangleMeshShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btBvhTriangleMeshShape>(flat_mesh(), true);
       }},
      {"btScaledBvhTriangleMeshShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btScaledBvhTriangleMeshShape>(
             &w.make<btBvhTriangleMeshShape>(large_flat_mesh(), true),
             to_bullet(Vec3{0.1, 0.1, 0.1}));
       }},
      {"btMultimaterialTriangleMeshShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btMultimaterialTriangleMeshShape>(flat_mesh(), true);
       }},
      {"btHeightfieldTerrainShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btHeightfieldTerrainShape>(3, 3, heights.data(), btScalar(-1), btScalar(1),
                                                  2, false);
       }},
      {"btGImpactMeshShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         auto& mesh = w.make<btGImpactMeshShape>(flat_mesh());
         mesh.setMargin(0);
         mesh.updateBound();
         return mesh;
       }},
      {"btGImpactCompoundShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         auto& compound = w.make<btGImpactCompoundShape>();
         compound.addChildShape(btTransform::getIdentity(),
                                &w.make<btBoxShape>(to_bullet(Vec3{0.3, 0.3, 0.1})));
         compound.updateBound();
         return compound;
       }},
      {"btCompoundShape", 0.1,
       [](TestWorld& w) -> btCollisionShape& {
         auto& compound = w.make<btCompoundShape>();
         compound.addChildShape(btTransform::getIdentity(),
                                &w.make<btBoxShape>(to_bullet(Vec3{0.3, 0.3, 0.1})));
         return compound;
       }},
      {"btEmptyShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& { return w.make<btEmptyShape>(); }},
      {"btSdfCollisionShape", 0.0,
       [](TestWorld& w) -> btCollisionShape& {
         /// As large as the others; what it holds does not matter.
         struct Sdf : btSdfCollisionShape {
           void getAabb(const btTransform& t, btVector3& lower, btVector3& upper) const override {
             lower = t.getOrigin() - btVector3(1, 1, 1);
             upper = t.getOrigin() + btVector3(1, 1, 1);
           }
         };
         return w.make<Sdf>();
       }},
  };
  return all;
}

std::string describe(double depth) {
  if (depth < 0.0) return "none";
  // Bullet's own algorithms are off by parts of their margins.
  return std::abs(depth - kDepth) < 1.2e-3 ? "found" : "WRONG " + std::to_string(depth);
}

/// What becomes of a cube that reaches kDepth into its partner from above: in the world's step, and
/// in a contact test of the pair.
std::string meet(const Partner& partner, bool cube_first, bool compounds) {
  TestWorld world;
  const auto wrap = [&](btCollisionShape& shape) -> btCollisionShape& {
    if (!compounds) return shape;
    auto& compound = world.make<btCompoundShape>();
    compound.addChildShape(to_bullet(Pose{{}, {0, 0, 0.25}}), &shape);
    return compound;
  };
  btRigidBody* cube = nullptr;
  btRigidBody* other = nullptr;
  const double sunk = compounds ? 0.25 : 0.0;
  const auto add_cube = [&] {
    cube = &world.add(wrap(world.make<ModelShape>(cube_model())), 1,
                      {{}, {0.02, 0.01, kCubeHalf - kDepth - sunk}});
  };
  if (cube_first) add_cube();
  // Bullet refuses planes as children.
  btCollisionShape& shape = partner.make(world);
  const bool is_plane = shape.getShapeType() == STATIC_PLANE_PROXYTYPE;
  other = &world.add(is_plane ? shape : wrap(shape), 0,
                     {{}, {0, 0, -partner.top - (is_plane ? 0.0 : sunk)}});
  if (!cube_first) add_cube();
#ifdef __SANITIZE_ADDRESS__
  // What is thrown through Bullet's algorithm of compounds leaves its arrays behind.
  std::optional<__lsan::ScopedDisabler> unwatched;
  if (!check_served(shape)) unwatched.emplace();
#endif
  try {
    world.world.performDiscreteCollisionDetection();
    double deepest = -1.0;
    for (const btManifoldPoint* point : world.points()) {
      deepest = std::max(deepest, -static_cast<double>(point->getDistance()));
      const double upwards = std::abs(static_cast<double>(point->m_normalWorldOnB.z()));
      EXPECT_GT(upwards, 0.7) << partner.shape;
    }
    DeepestResult tested;
    world.world.contactPairTest(cube_first ? cube : other, cube_first ? other : cube, tested);
    const std::string in_step = describe(deepest);
    const std::string in_test = describe(tested.depth);
    return in_step == in_test ? in_step : in_step + " / " + in_test;
  } catch (const std::logic_error& error) {
    EXPECT_NE(std::string(error.what()).find("ModelShape"), std::string::npos);
    EXPECT_FALSE(check_served(shape));
    EXPECT_THROW(
        {
          DeepestResult tested;
          world.world.contactPairTest(cube, other, tested);
        },
        std::logic_error);
    return "refused";
  }
}

const char* way_of(const std::string& shape) {
  if (shape == "voxshell ModelShape") return "shell of one body in the field of the other";
  if (shape == "btCompoundShape") return "each child by its own method";
  if (shape == "btEmptyShape") return "no contacts: the shape is empty";
  if (shape == "btSdfCollisionShape" || shape == "btGImpactCompoundShape") {
    return "`std::logic_error`";
  }
  for (const char* analytic : {"btBoxShape", "btSphereShape", "btCapsuleShape", "btCylinderShape",
                               "btConeShape", "btStaticPlaneShape"}) {
    if (shape == analytic) return "shell in an analytic field";
  }
  for (const char* hull : {"btConvexHullShape", "btConvexPointCloudShape",
                           "btConvexTriangleMeshShape", "btBU_Simplex1to4"}) {
    if (shape == hull) return "shell in the field of its hull";
  }
  for (const char* mesh :
       {"btBvhTriangleMeshShape", "btScaledBvhTriangleMeshShape",
        "btMultimaterialTriangleMeshShape", "btHeightfieldTerrainShape", "btGImpactMeshShape"}) {
    if (shape == mesh) return "triangles in the model's field";
  }
  return "Bullet's GJK with the model's triangles";
}

std::string make_table() {
  std::ostringstream table;
  table
      << "# Bullet's shapes and models\n\n"
         "This table lists how each of Bullet's shapes collides with a model. The test "
         "`PairTable.IsThatOfTheDocs` writes the\ntable if `VOXSHELL_WRITE_DOCS=1` is set, and "
         "fails "
         "if the table is out of date. In the test a cube overlaps each shape from\nabove by 4 mm. "
         "\"Found\" means that the world's step and `contactPairTest` both report that depth to "
         "within 1.2 mm. The columns tell\nwhether the model is the first or the second body of "
         "the "
         "pair. In the last two columns both bodies are in compounds.\n\n"
         "| shape | collision method | model first | model second | in compounds: first | "
         "second |\n|---|---|---|---|---|---|\n";
  for (const Partner& partner : partners()) {
    table << "| " << partner.shape << " | " << way_of(partner.shape);
    for (const bool compounds : {false, true}) {
      for (const bool cube_first : {true, false}) {
        table << " | " << meet(partner, cube_first, compounds);
      }
    }
    table << " |\n";
  }
  table << "\nvoxshell also refuses soft bodies and fluids. Ghost objects, kinematic bodies and "
           "static bodies collide with models as other\nbodies do.\n";
  return table.str();
}

TEST(PairTable, IsThatOfTheDocs) {
  const std::string path = VOXSHELL_DOCS_DIR "/bullet-pairs.md";
  const std::string table = make_table();
  EXPECT_EQ(table.find("WRONG"), std::string::npos);
  if (std::getenv("VOXSHELL_WRITE_DOCS") != nullptr) std::ofstream(path) << table;
  std::ifstream file(path);
  std::ostringstream kept;
  kept << file.rdbuf();
  EXPECT_EQ(table, kept.str());
}

TEST(PairTable, RefusesSoftBodiesAndFluids) {
  CollisionConfiguration configuration;
  for (const int type : {SOFTBODY_SHAPE_PROXYTYPE, HFFLUID_SHAPE_PROXYTYPE}) {
    for (const bool model_first : {true, false}) {
      const int a = model_first ? FAST_CONCAVE_MESH_PROXYTYPE : type;
      const int b = model_first ? type : FAST_CONCAVE_MESH_PROXYTYPE;
      EXPECT_EQ(configuration.getCollisionAlgorithmCreateFunc(a, b),
                configuration.getCollisionAlgorithmCreateFunc(FAST_CONCAVE_MESH_PROXYTYPE,
                                                              SDF_SHAPE_PROXYTYPE));
    }
  }
}

TEST(Ghosts, SeeModelsAndAreSeenByThem) {
  TestWorld world;
  btGhostPairCallback callback;
  world.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&callback);
  btPairCachingGhostObject ghost;
  ghost.setCollisionShape(&world.make<ModelShape>(slab_model()));
  ghost.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
  world.world.addCollisionObject(&ghost, btBroadphaseProxy::SensorTrigger,
                                 btBroadphaseProxy::AllFilter);
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, 0.15}});
  int touching = 0;
  for (int i = 0; i < 100; ++i) {
    world.step(1);
    touching += world.points().empty() ? 0 : 1;
    EXPECT_EQ(ghost.getNumOverlappingObjects() > 0, height(cube) > -0.25) << height(cube);
    if (height(cube) < -0.2) break;
  }
  EXPECT_GT(touching, 10);
  EXPECT_LT(height(cube), -0.2);  // triggers hold nothing up
  world.world.removeCollisionObject(&ghost);
}

TEST(Kinematic, ModelsPushOthers) {
  TestWorld world({}, {0, 0, 0});
  btRigidBody& pusher = world.add_model(slab_model(), 0);
  pusher.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  pusher.setActivationState(DISABLE_DEACTIVATION);
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + 0.01}});
  cube.setActivationState(DISABLE_DEACTIVATION);
  for (int i = 1; i <= 100; ++i) {
    pusher.setWorldTransform(to_bullet(Pose{{}, {0, 0, 0.002 * i}}));
    world.step(1);
  }
  EXPECT_NEAR(height(cube), kCubeHalf + 0.2, 0.005);
}

}  // namespace
}  // namespace voxshell::bullet::pair_table_test
