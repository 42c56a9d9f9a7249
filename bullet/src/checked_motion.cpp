#include "voxshell/bullet/checked_motion.h"

#include <algorithm>
#include <map>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "blows.h"
#include "compound_algorithm.h"
#include "contact_constants.h"
#include "solved_motion_search.h"
#include "step_end.h"

namespace voxshell::bullet {
namespace {

/// Searches for contacts of bodies that turn into each other.
class SearchEnds : public btOverlapCallback {
 public:
  SearchEnds(StepEnd& step_end, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info)
      : step_end_(step_end), dispatcher_(dispatcher), info_(info) {}

  bool processOverlap(btBroadphasePair& pair) override {
    auto* const a = static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    auto* const b = static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    btRigidBody* const body_a = btRigidBody::upcast(a);
    btRigidBody* const body_b = btRigidBody::upcast(b);
    if (pair.m_algorithm == nullptr || body_a == nullptr || body_b == nullptr) return false;
    if (!a->isActive() && !b->isActive()) return false;
    if (!dispatcher_.needsResponse(a, b)) return false;
    if (!has_model(*a->getCollisionShape()) && !has_model(*b->getCollisionShape())) return false;
    const bool has_added =
        step_end_.add_contacts(*pair.m_algorithm, *body_a, *body_b, dispatcher_, info_);
    has_found_ = has_found_ || has_added;
    return false;  // the pair stays
  }

  bool has_found() const { return has_found_; }

 private:
  StepEnd& step_end_;
  btCollisionDispatcher& dispatcher_;
  const btDispatcherInfo& info_;
  bool has_found_ = false;
};

/// Undoes a factor by axis; where that is 0, so is what it made.
btVector3 divide(const btVector3& v, const btVector3& factor) {
  const auto by = [](btScalar x, btScalar f) { return f != 0 ? x / f : btScalar(0); };
  return {by(v.x(), factor.x()), by(v.y(), factor.y()), by(v.z(), factor.z())};
}

/// Kinetic, J.
btScalar energy_of(const btRigidBody& body, btScalar speed, const btVector3& angular_velocity) {
  const btVector3 spin = body.getWorldTransform().getBasis().transpose() * angular_velocity;
  const btVector3 turning = divide(spin * spin, body.getInvInertiaDiagLocal());
  return btScalar(0.5) *
         (speed * speed / body.getInvMass() + turning.x() + turning.y() + turning.z());
}

}  // namespace

CheckedMotion::State CheckedMotion::State::of(const btRigidBody& body) {
  return {body.getWorldTransform(), body.getLinearVelocity(), body.getAngularVelocity()};
}

void CheckedMotion::State::put_on(btRigidBody& body) const {
  body.setWorldTransform(world_from_body);
  body.setLinearVelocity(linear_velocity);
  body.setAngularVelocity(angular_velocity);
}

CheckedMotion::State CheckedMotion::Checked::go_on() const {
  return {before.world_from_body, solved.linear_velocity, solved.angular_velocity};
}

CheckedMotion::CheckedMotion()
    : blows_(std::make_unique<Blows>()),
      search_(std::make_unique<SolvedMotionSearch>()),
      step_end_(std::make_unique<StepEnd>()) {}

CheckedMotion::~CheckedMotion() = default;

void CheckedMotion::begin(const btAlignedObjectArray<btRigidBody*>& bodies,
                          btDispatcher& dispatcher, btScalar time_step) {
  solutions_ = 1;
  solutions_of_turns_ = 0;
  stopped_.clear();
  all_.clear();
  blows_->begin(dispatcher, time_step);
  for (int i = 0; i < bodies.size(); ++i) {
    btRigidBody& body = *bodies[i];
    // Those that sleep, too: the solver wakes what is hit.
    if (!(body.getInvMass() > 0)) continue;
    const State before = State::of(body);
    all_.push_back(
        {&body, before, before, before, body.getTotalForce(), body.getTotalTorque(), false});
  }
}

/// Whether some place of the body moves farther than the search for contacts expected, by half of
/// what it expected and a fraction of the body's size.
bool CheckedMotion::is_faster(const Checked& checked, btScalar time_step) {
  const btRigidBody& body = *checked.body;
  const btScalar size = body.getCollisionShape()->getAngularMotionDisc();
  const auto displacement = [&](const btVector3& linear, const btVector3& angular) {
    return time_step * (linear.length() + size * angular.length());
  };
  const State& before = checked.before;
  const State& solved = checked.solved;
  const btScalar least = static_cast<btScalar>(kCheckedOfSize) * size;
  if (displacement(solved.linear_velocity, solved.angular_velocity) <= least) return false;
  const btVector3 of_forces = (body.getInvMass() * time_step) * checked.force;
  const btVector3 change = solved.linear_velocity - before.linear_velocity;
  const btVector3 turning = solved.angular_velocity - before.angular_velocity;
  const btScalar unexpected =
      std::min(displacement(change, turning), displacement(change - of_forces, turning));
  const btScalar expected = displacement(before.linear_velocity, before.angular_velocity);
  return unexpected > static_cast<btScalar>(kCheckedOfExpected) * expected + least;
}

bool CheckedMotion::find_contacts(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                                  const btDispatcherInfo& info, CoulombSolver* solver) {
  if (solutions_ < kMostSolutions && is_unfinished(broadphase, dispatcher, info, solver)) {
    ++solutions_;
    return true;
  }
  blows_->finish();
  if (solutions_ == kMostSolutions) find_stopped(info.m_timeStep);
  return false;
}

/// Finds what the last solution, which was solved for that, took from bodies. Friction at several
/// walls at once may have given an island energy: that is not given back.
void CheckedMotion::find_stopped(btScalar time_step) {
  struct Energies {
    btScalar before = 0;
    btScalar after = 0;
  };
  std::map<int, Energies> by_island;
  for (const Checked& checked : all_) {
    const btRigidBody& body = *checked.body;
    if (!blows_->reach(body)) continue;
    const btScalar by_forces = body.getInvMass() * time_step * body.getTotalForce().length();
    Energies& of = by_island[body.getIslandTag()];
    of.before += energy_of(body, checked.before.linear_velocity.length() + by_forces,
                           checked.before.angular_velocity);
    of.after +=
        energy_of(body, checked.solved.linear_velocity.length(), checked.solved.angular_velocity);
  }
  for (const Checked& checked : all_) {
    const btRigidBody& body = *checked.body;
    if (!blows_->reach(body)) continue;
    const Energies& of = by_island[body.getIslandTag()];
    const btScalar kept = of.after > of.before ? btSqrt(of.before / of.after) : btScalar(1);
    stopped_.push_back({checked.body,
                        kept * checked.solved.linear_velocity - body.getLinearVelocity(),
                        kept * checked.solved.angular_velocity - body.getAngularVelocity()});
  }
}

void CheckedMotion::drop_added() { search_->drop_added(); }

void CheckedMotion::release() {
  for (const Stopped& stopped : stopped_) {
    stopped.body->setLinearVelocity(stopped.body->getLinearVelocity() + stopped.linear);
    stopped.body->setAngularVelocity(stopped.body->getAngularVelocity() + stopped.angular);
  }
  stopped_.clear();
}

/// Looks for contacts. If the step is to be solved again, bodies are as the next solution is to
/// begin, else as the last one left them.
bool CheckedMotion::is_unfinished(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                                  const btDispatcherInfo& info, CoulombSolver* solver) {
  faster_.clear();
  for (Checked& checked : all_) {
    checked.solved = State::of(*checked.body);
    // One that has come back may be as fast as before the step, but elsewhere.
    checked.is_faster = checked.is_faster || is_faster(checked, info.m_timeStep);
    if (checked.is_faster) faster_.push_back(checked.body);
  }
  const bool is_searched = !faster_.empty() || blows_->has_changed();
  bool has_turned = !is_searched && find_turned(broadphase, dispatcher, info);
  if (!is_searched && !has_turned) return false;
  for (const Checked& checked : all_) checked.start.put_on(*checked.body);
  faster_by_address_.assign(faster_.begin(), faster_.end());
  std::ranges::sort(faster_by_address_);
  blows_->find(dispatcher, faster_by_address_, info.m_timeStep);
  for (const Checked& checked : all_) {
    // Their velocity has what forces add.
    checked.go_on().put_on(*checked.body);
    checked.body->clearForces();
  }
  const bool has_come_back = blows_->restore(info.m_timeStep);
  const bool has_found = search_->find(faster_, faster_by_address_, broadphase,
                                       static_cast<btCollisionDispatcher&>(dispatcher), info);
  // Where more contacts are found, bodies will turn otherwise.
  if (is_searched && !has_found && !has_come_back) {
    has_turned = find_turned(broadphase, dispatcher, info);
    for (const Checked& checked : all_) checked.go_on().put_on(*checked.body);
  }
  const bool is_unfinished = has_found || has_come_back || has_turned;
  if (is_unfinished) {
    blows_->keep(dispatcher, info.m_timeStep);
    if (solutions_ == kMostSolutions - 1) blows_->stop(dispatcher);
  }
  for (const Checked& checked : all_) {
    (is_unfinished ? checked.before : checked.solved).put_on(*checked.body);
    checked.body->applyCentralForce(divide(checked.force, checked.body->getLinearFactor()));
    checked.body->applyTorque(divide(checked.torque, checked.body->getAngularFactor()));
  }
  if (!is_unfinished) return false;
  continue_from_last(info.m_timeStep, solver);
  for (Checked& checked : all_) checked.start = State::of(*checked.body);
  return true;
}

/// Where blows are passed on, the next solution begins with the velocities that the last one found,
/// without what forces add in either.
void CheckedMotion::continue_from_last(btScalar time_step, CoulombSolver* solver) {
  continued_.clear();
  for (const Checked& checked : all_) {
    btRigidBody& body = *checked.body;
    if (!blows_->reach(body)) continue;
    const btVector3 by_forces = time_step * body.getInvMass() * checked.force;
    const btVector3 by_torques = time_step * (body.getInvInertiaTensorWorld() * checked.torque);
    body.setLinearVelocity(checked.solved.linear_velocity - by_forces);
    body.setAngularVelocity(checked.solved.angular_velocity - by_torques);
    continued_.push_back(&body);
  }
  std::ranges::sort(continued_);
  if (solver != nullptr) solver->continue_from_last(continued_);
}

/// Looks where bodies that turn end the step, in pairs that have contacts.
bool CheckedMotion::find_turned(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                                const btDispatcherInfo& info) {
  if (solutions_of_turns_ == kMostSolutionsOfTurns) return false;
  for (const Checked& checked : all_) checked.go_on().put_on(*checked.body);
  SearchEnds search(*step_end_, static_cast<btCollisionDispatcher&>(dispatcher), info);
  broadphase.getOverlappingPairCache()->processAllOverlappingPairs(&search, &dispatcher, info);
  for (const Checked& checked : all_) checked.solved.put_on(*checked.body);
  if (search.has_found()) ++solutions_of_turns_;
  return search.has_found();
}

}  // namespace voxshell::bullet
