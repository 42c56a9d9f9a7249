#include "voxshell/bullet/taut_joints.h"

#include <cstddef>
#include <optional>
#include <utility>

#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>

#include "solver_constants.h"

namespace voxshell::bullet {
namespace {

using Places = std::pair<btVector3, btVector3>;

/// Where a joint holds its two bodies, in their frames; none of kinds that are not known.
std::optional<Places> places_of(const btTypedConstraint& joint) {
  switch (joint.getConstraintType()) {
    case POINT2POINT_CONSTRAINT_TYPE: {
      const auto& point = static_cast<const btPoint2PointConstraint&>(joint);
      return Places{point.getPivotInA(), point.getPivotInB()};
    }
    case HINGE_CONSTRAINT_TYPE: {
      const auto& hinge = static_cast<const btHingeConstraint&>(joint);
      return Places{hinge.getAFrame().getOrigin(), hinge.getBFrame().getOrigin()};
    }
    case SLIDER_CONSTRAINT_TYPE: {
      const auto& slider = static_cast<const btSliderConstraint&>(joint);
      return Places{slider.getFrameOffsetA().getOrigin(), slider.getFrameOffsetB().getOrigin()};
    }
    case D6_CONSTRAINT_TYPE:
    case D6_SPRING_CONSTRAINT_TYPE: {
      const auto& axes = static_cast<const btGeneric6DofConstraint&>(joint);
      return Places{axes.getFrameOffsetA().getOrigin(), axes.getFrameOffsetB().getOrigin()};
    }
    case D6_SPRING_2_CONSTRAINT_TYPE: {
      const auto& axes = static_cast<const btGeneric6DofSpring2Constraint&>(joint);
      return Places{axes.getFrameOffsetA().getOrigin(), axes.getFrameOffsetB().getOrigin()};
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

void TautJoints::begin(const btAlignedObjectArray<btTypedConstraint*>& joints, btScalar time_step) {
  pulled_.clear();
  for (int i = 0; i < joints.size(); ++i) {
    btTypedConstraint& joint = *joints[i];
    const btJointFeedback* const last = joint.getJointFeedback();
    if (last == nullptr || !joint.isEnabled()) continue;
    const auto places = places_of(joint);
    if (!places) continue;
    pull(joint.getRigidBodyA(), places->first, last->m_appliedForceBodyA);
    pull(joint.getRigidBodyB(), places->second, last->m_appliedForceBodyB);
  }
  const btScalar of_stiffness = static_cast<btScalar>(kFollowedStiffness) * time_step * time_step;
  std::erase_if(pulled_, [&](const Pulled& pulled) {
    if (pulled.body == nullptr) return true;
    btVector3 inverse = pulled.inverse_inertia;
    for (int axis = 0; axis < 3; ++axis) {
      const btScalar least = of_stiffness * pulled.stiffness[axis];
      if (least * inverse[axis] > 1) inverse[axis] = 1 / least;
    }
    if (inverse == pulled.inverse_inertia) return true;
    pulled.body->setInvInertiaDiagLocal(inverse);
    pulled.body->updateInertiaTensor();
    return false;
  });
}

void TautJoints::end() {
  for (const Pulled& pulled : pulled_) {
    pulled.body->setInvInertiaDiagLocal(pulled.inverse_inertia);
    pulled.body->updateInertiaTensor();
  }
}

/// By a force, world frame, at a place of the body.
void TautJoints::pull(btRigidBody& body, const btVector3& place, const btVector3& force) {
  if (!(body.getInvMass() > 0) || body.getWorldArrayIndex() < 0) return;
  const auto index = static_cast<std::size_t>(body.getWorldArrayIndex());
  if (index >= pulled_.size()) pulled_.resize(index + 1);
  Pulled& pulled = pulled_[index];
  if (pulled.body == nullptr) {
    pulled.body = &body;
    pulled.inverse_inertia = body.getInvInertiaDiagLocal();
  }
  const btVector3 of_body = force * body.getWorldTransform().getBasis();
  const btScalar outward = place.dot(of_body);
  pulled.stiffness += btVector3(outward, outward, outward) - place * of_body;
}

}  // namespace voxshell::bullet
