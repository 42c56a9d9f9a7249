#include "bullet/bindings.h"
#include "bullet/conversions.h"
#include "bullet/joint.h"
#include "in_ordinary_floats.h"

namespace nb = nanobind;

namespace voxshell::python {

void bind_joints(nb::module_& module) {
  nb::enum_<JointKind>(module, "JointKind")
      .value("FIXED", JointKind::kFixed)
      .value("HINGE", JointKind::kHinge)
      .value("SLIDER", JointKind::kSlider)
      .value("POINT", JointKind::kPoint);

  nb::class_<JointSettings>(module, "JointSettings")
      .def(
          "__init__",
          [](JointSettings* self, JointKind kind, int parent, int child,
             const PoseMatrix& parent_from_joint, const PoseMatrix& child_from_joint, double lower,
             double upper, double friction, double damping, double stiffness,
             double spring_position, double armature, bool collides) {
            new (self) JointSettings{kind,
                                     parent,
                                     child,
                                     to_pose(parent_from_joint),
                                     to_pose(child_from_joint),
                                     lower,
                                     upper,
                                     friction,
                                     damping,
                                     stiffness,
                                     spring_position,
                                     armature,
                                     collides};
          },
          nb::kw_only(), nb::arg("kind"), nb::arg("parent"), nb::arg("child"),
          nb::arg("parent_from_joint"), nb::arg("child_from_joint"), nb::arg("lower"),
          nb::arg("upper"), nb::arg("friction"), nb::arg("damping"), nb::arg("stiffness"),
          nb::arg("spring_position"), nb::arg("armature"), nb::arg("collides"), InOrdinaryFloats());

  nb::enum_<MotorMode>(module, "MotorMode")
      .value("NONE", MotorMode::kNone)
      .value("VELOCITY", MotorMode::kVelocity)
      .value("POSITION", MotorMode::kPosition)
      .value("FOLLOW", MotorMode::kFollow);

  nb::class_<Motor>(module, "Motor")
      .def(
          "__init__",
          [](Motor* self, MotorMode mode, double target, double max_force, double max_speed,
             int leader, double multiplier, double velocity) {
            new (self) Motor{mode, target, max_force, max_speed, leader, multiplier, velocity};
          },
          nb::arg("mode"), nb::arg("target"), nb::arg("max_force"), nb::arg("max_speed"),
          nb::arg("leader") = -1, nb::arg("multiplier") = 1.0, nb::arg("velocity") = 0.0)
      .def_ro("mode", &Motor::mode)
      .def_ro("target", &Motor::target)
      .def_ro("max_force", &Motor::max_force)
      .def_ro("max_speed", &Motor::max_speed)
      .def_ro("leader", &Motor::leader)
      .def_ro("multiplier", &Motor::multiplier)
      .def_ro("velocity", &Motor::velocity);

  nb::class_<JointReading>(module, "JointReading")
      .def_ro("position", &JointReading::position)
      .def_ro("velocity", &JointReading::velocity);
}

}  // namespace voxshell::python
