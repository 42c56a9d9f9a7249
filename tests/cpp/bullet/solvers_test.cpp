#include <algorithm>
#include <memory>
#include <string>

#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>
#include <gtest/gtest.h>

#include "support/drop.h"
#include "support/ground.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

enum class Solver { kSequentialImpulse, kNncg, kDantzig, kProjectedGaussSeidel };

const char* to_string(Solver solver) {
  switch (solver) {
    case Solver::kSequentialImpulse:
      return "SequentialImpulse";
    case Solver::kNncg:
      return "Nncg";
    case Solver::kDantzig:
      return "Dantzig";
    case Solver::kProjectedGaussSeidel:
      return "ProjectedGaussSeidel";
  }
  return "";
}

/// One of Bullet's solvers of constraints with what it needs.
struct OwnedSolver {
  std::unique_ptr<btMLCPSolverInterface> lcp;  ///< of those that solve all constraints as one
  std::unique_ptr<btConstraintSolver> solver;
};

OwnedSolver make_solver(Solver which) {
  OwnedSolver owned;
  switch (which) {
    case Solver::kSequentialImpulse:
      owned.solver = std::make_unique<btSequentialImpulseConstraintSolver>();
      return owned;
    case Solver::kNncg:
      owned.solver = std::make_unique<btNNCGConstraintSolver>();
      return owned;
    case Solver::kDantzig:
      owned.lcp = std::make_unique<btDantzigSolver>();
      break;
    case Solver::kProjectedGaussSeidel:
      owned.lcp = std::make_unique<btSolveProjectedGaussSeidel>();
      break;
  }
  owned.solver = std::make_unique<btMLCPSolver>(owned.lcp.get());
  return owned;
}

class Solvers : public testing::TestWithParam<std::tuple<Solver, Ground, ContactMode>> {};

INSTANTIATE_TEST_SUITE_P(
    OnGrounds, Solvers,
    testing::Combine(testing::Values(Solver::kSequentialImpulse, Solver::kNncg, Solver::kDantzig,
                                     Solver::kProjectedGaussSeidel),
                     testing::Values(Ground::kPlane, Ground::kBox, Ground::kModel),
                     testing::Values(ContactMode::kRegular, ContactMode::kSegmented)),
    [](const auto& tested) {
      return std::string(to_string(std::get<0>(tested.param))) + "On" +
             to_string(std::get<1>(tested.param)) +
             (std::get<2>(tested.param) == ContactMode::kRegular ? "Regular" : "Segmented");
    });

TEST_P(Solvers, BringADroppedModelToRest) {
  const auto& [which, ground, mode] = GetParam();
  Random random(51);
  for (const double restitution : {0.0, 0.5}) {
    for (const auto& model : {blob_model(), torus_model()}) {
      SCOPED_TRACE(std::string(model == blob_model() ? "blob" : "torus") + ", restitution " +
                   std::to_string(restitution));
      const OwnedSolver owned = make_solver(which);
      TestWorld world({.mode = mode, .rolling_at_rest = which != Solver::kNncg});
      world.world.setConstraintSolver(owned.solver.get());
      btRigidBody& floor = add_ground(world, ground);
      floor.setFriction(1);
      floor.setRestitution(1);
      btRigidBody& body = add_at_principal_frame(world, model, 1, {random.rotation(), {0, 0, 0.3}});
      body.setFriction(scalar(0.8));
      body.setRestitution(scalar(restitution));
      body.setDamping(0, scalar(0.05));
      body.setActivationState(DISABLE_DEACTIVATION);
      if (restitution > 0.0) {
        expect_true_landing(world, body, 400);
      } else {
        // Without rolling friction, some landings end in rocking.
        constexpr double kRocking = 0.2;
        const bool rocks = which == Solver::kProjectedGaussSeidel;
        expect_calm_landing(world, body, rocks ? std::max(kRocking, kCalm) : kCalm);
      }
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet
