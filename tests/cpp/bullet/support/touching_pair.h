#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::test_support {

/// What a cube (a model, or a compound with one) sinks into from above.
enum class Partner {
  kPlane,
  kBox,
  kSphere,
  kModel,       ///< more points than the cube, which thus is the shell
  kSmallModel,  ///< fewer points: the cube is the field
  kCompoundOfBoxes,
  kCompoundOfModels,
};

inline constexpr Partner kAllPartners[] = {Partner::kPlane,           Partner::kBox,
                                           Partner::kSphere,          Partner::kModel,
                                           Partner::kSmallModel,      Partner::kCompoundOfBoxes,
                                           Partner::kCompoundOfModels};

enum class Wrapping { kBare, kCompound, kCompoundWithoutTree };

struct PairCase {
  Partner partner;
  Wrapping wrapping;  ///< of the cube
  bool cube_first;    ///< which is added first, and thus is the pair's body 0
  double cube_mass;
  double partner_mass;
};

inline std::string to_string(Partner partner) {
  switch (partner) {
    case Partner::kPlane:
      return "Plane";
    case Partner::kBox:
      return "Box";
    case Partner::kSphere:
      return "Sphere";
    case Partner::kModel:
      return "Model";
    case Partner::kSmallModel:
      return "SmallModel";
    case Partner::kCompoundOfBoxes:
      return "CompoundOfBoxes";
    case Partner::kCompoundOfModels:
      return "CompoundOfModels";
  }
  return {};
}

inline std::string to_string(const PairCase& c) {
  return to_string(c.partner) + ", wrapping " + std::to_string(static_cast<int>(c.wrapping)) +
         (c.cube_first ? ", cube first" : ", partner first") + ", masses " +
         std::to_string(c.cube_mass) + " and " + std::to_string(c.partner_mass);
}

/// Every wrapping, order and way of being static.
inline std::vector<PairCase> all_pair_cases(Partner partner) {
  std::vector<PairCase> cases;
  for (const Wrapping wrapping :
       {Wrapping::kBare, Wrapping::kCompound, Wrapping::kCompoundWithoutTree}) {
    for (const bool cube_first : {true, false}) {
      cases.push_back({partner, wrapping, cube_first, 1.0, 0.0});
      if (partner == Partner::kPlane) continue;
      cases.push_back({partner, wrapping, cube_first, 0.0, 1.0});
      cases.push_back({partner, wrapping, cube_first, 1.0, 1.0});
    }
  }
  return cases;
}

/// A cube whose lower face is `depth` below the top of its partner, along `up`, all of it moved by
/// one rigid transform, so that no axis and no origin is special.
class TouchingPair {
 public:
  TouchingPair(const PairCase& c, double depth, const ContactSettings& settings = {})
      : world(settings, {}), margin_(std::max(settings.margin, 0.0)), up(scene_.rotate({0, 0, 1})) {
    if (c.cube_first) {
      add_cube(c, depth);
      add_partner(c);
    } else {
      add_partner(c);
      add_cube(c, depth);
    }
  }

 private:
  /// Compounds want a margin above the default in the bounds, too.
  ModelShape& make_model(const std::shared_ptr<const Model>& model) {
    auto& shape = world.make<ModelShape>(model);
    shape.setMargin(scalar(margin_));
    return shape;
  }

  void add_cube(const PairCase& c, double depth) {
    const Pose at = scene_ * Pose{{}, {0, 0, kCubeHalf - depth}};
    if (c.wrapping == Wrapping::kBare) {
      cube = &world.add(make_model(cube_model()), c.cube_mass, at);
      return;
    }
    // Far from the compound's origin, beside a second child that touches nothing.
    const Pose child{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {0.5, -0.2, 0.3}};
    auto& compound = world.make<btCompoundShape>(c.wrapping == Wrapping::kCompound);
    auto& model = make_model(cube_model());
    compound.addChildShape(to_bullet(Pose{{}, {0, 0, 2}}), &model);
    compound.addChildShape(to_bullet(child), &model);
    cube = &world.add(compound, c.cube_mass, at * child.inverse());
  }

  void add_partner(const PairCase& c) {
    const auto put = [&](btCollisionShape& shape, double drop) {
      partner = &world.add(shape, c.partner_mass, scene_ * Pose{{}, {0, 0, -drop}});
    };
    switch (c.partner) {
      case Partner::kPlane:
        return put(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), scalar(0.25)), 0.25);
      case Partner::kBox:
        return put(world.make<btBoxShape>(to_bullet(Vec3{0.3, 0.25, 0.2})), 0.2);
      case Partner::kSphere:
        return put(world.make<btSphereShape>(scalar(0.3)), 0.3);
      case Partner::kModel:
        return put(make_model(slab_model()), 0.0);
      case Partner::kSmallModel: {
        static const auto small =
            build_model(voxshell::test_support::make_box({0.05, 0.05, 0.05}), 0.01);
        return put(make_model(small), 0.05);
      }
      case Partner::kCompoundOfBoxes: {
        auto& compound = world.make<btCompoundShape>();
        auto& box = world.make<btBoxShape>(to_bullet(Vec3{0.2, 0.2, 0.1}));
        compound.addChildShape(to_bullet(Pose{{}, {0, 0, 0.4}}), &box);
        compound.addChildShape(to_bullet(Pose{{}, {0, 0, -1}}), &box);
        return put(compound, 0.5);
      }
      case Partner::kCompoundOfModels: {
        auto& compound = world.make<btCompoundShape>();
        auto& slab = make_model(slab_model());
        compound.addChildShape(to_bullet(Pose{{}, {0, 0, 0.5}}), &slab);
        compound.addChildShape(to_bullet(Pose{{}, {0, 0, -1}}), &slab);
        return put(compound, 0.5);
      }
    }
  }

  Pose scene_ = voxshell::test_support::Random(7).pose(1.0);

 public:
  TestWorld world;

 private:
  double margin_;

 public:
  Vec3 up;
  btRigidBody* cube = nullptr;
  btRigidBody* partner = nullptr;
};

}  // namespace voxshell::bullet::test_support
