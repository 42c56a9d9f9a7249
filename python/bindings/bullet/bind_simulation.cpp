#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bullet/bindings.h"
#include "bullet/conversions.h"
#include "bullet/shared_simulation.h"
#include "bullet/simulation_state.h"
#include "bullet/state_rows.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

using Clock = std::chrono::steady_clock;

/// Makes up to `count` steps, until Python must handle signals; returns how many are left, or 0 if
/// a body's pose is no longer finite. Runs without the GIL. Other threads take turns between steps.
std::size_t step_for_a_while(SharedSimulation& simulation, std::size_t count) {
  constexpr auto kSignalCheckEvery = std::chrono::milliseconds(10);
  const ReleasedInterpreter released;
  const OrdinaryFloats floats;
  const auto end = Clock::now() + kSignalCheckEvery;
  while (count > 0 && Clock::now() < end) {
    const std::lock_guard turn(simulation.lock);
    bool goes_on = true;
    simulation.change([&](Simulation& own) {
      own.step();
      goes_on = !own.find_lost_body();
    });
    if (!goes_on) return 0;
    --count;
  }
  return count;
}

void step(SharedSimulation& simulation, std::size_t count) {
  while (count > 0) {
    count = step_for_a_while(simulation, count);
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
}

/// Seconds for each step: whole step, narrow phase, and its query, reduction and manifold parts.
nb::ndarray<nb::numpy, double> timings(const Simulation& simulation) {
  std::vector<std::array<double, 5>> rows;
  rows.reserve(simulation.timings().size());
  for (const StepTimings& t : simulation.timings()) {
    rows.push_back({t.step, t.narrow_phase, t.query, t.reduction, t.manifold});
  }
  return to_array(std::move(rows));
}

/// Rows: body a, body b, id, point on a, point on b, normal, depth, impulse, friction.
nb::ndarray<nb::numpy, double> to_rows(const std::vector<SimulationContact>& contacts) {
  std::vector<std::array<double, 17>> rows;
  rows.reserve(contacts.size());
  for (const SimulationContact& c : contacts) {
    rows.push_back({static_cast<double>(c.body_a), static_cast<double>(c.body_b),
                    static_cast<double>(c.id), c.point_a.x, c.point_a.y, c.point_a.z, c.point_b.x,
                    c.point_b.y, c.point_b.z, c.normal.x, c.normal.y, c.normal.z, c.depth,
                    c.impulse, c.friction.x, c.friction.y, c.friction.z});
  }
  return to_array(std::move(rows));
}

/// Rows: body, fraction, point, normal.
nb::ndarray<nb::numpy, double> cast_rays(const Simulation& simulation, const PointsArray& starts,
                                         const PointsArray& ends) {
  std::vector<RayHit> hits;
  {
    const std::vector<Vec3> from = read_points(starts);
    const std::vector<Vec3> to = read_points(ends);
    const ReleasedInterpreter released;
    hits = simulation.cast_rays(from, to);
  }
  std::vector<std::array<double, 8>> rows;
  rows.reserve(hits.size());
  for (const RayHit& h : hits) {
    rows.push_back({static_cast<double>(h.body), h.fraction, h.point.x, h.point.y, h.point.z,
                    h.normal.x, h.normal.y, h.normal.z});
  }
  return to_array(std::move(rows));
}

std::optional<Vec3> to_place(const std::optional<Coordinates>& place) {
  return place ? std::optional(to_vec3(*place)) : std::nullopt;
}

using Table = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// Tables of a state by name, and the members that they are.
constexpr std::array<std::pair<const char*, NumberTable StateRows::*>, 7> kTables{{
    {"whole", &StateRows::whole},
    {"bodies", &StateRows::bodies},
    {"joints", &StateRows::joints},
    {"apart", &StateRows::apart},
    {"manifolds", &StateRows::manifolds},
    {"points", &StateRows::points},
    {"contacts", &StateRows::contacts},
}};

/// (n, k) arrays by name.
std::map<std::string, nb::ndarray<nb::numpy, double>> read_rows(const SimulationState& state) {
  StateRows rows = to_rows(state);
  std::map<std::string, nb::ndarray<nb::numpy, double>> tables;
  for (const auto& [name, member] : kTables) {
    auto* owned = new NumberTable(std::move(rows.*member));
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<NumberTable*>(p); });
    const std::size_t count = owned->numbers.size() / owned->columns;
    tables.emplace(name, nb::ndarray<nb::numpy, double>(owned->numbers.data(),
                                                        {count, owned->columns}, owner));
  }
  return tables;
}

/// Raises a ValueError if the arrays are not those of any state.
std::shared_ptr<const SimulationState> write_rows(const std::map<std::string, Table>& tables) {
  StateRows rows;
  for (const auto& [name, member] : kTables) {
    const auto found = tables.find(name);
    if (found == tables.end()) {
      throw std::invalid_argument("it has no table '" + std::string(name) + "'");
    }
    const Table& table = found->second;
    (rows.*member).columns = table.shape(1);
    (rows.*member).numbers.assign(table.data(), table.data() + table.size());
  }
  return from_rows(rows);
}

}  // namespace

void bind_simulation(nb::module_& module) {
  nb::enum_<bullet::ContactMode>(module, "ContactMode")
      .value("AUTO", bullet::ContactMode::kAutomatic)
      .value("REGULAR", bullet::ContactMode::kRegular)
      .value("SEGMENTED", bullet::ContactMode::kSegmented);

  nb::enum_<bullet::ShellRule>(module, "ShellRule")
      .value("AUTO", bullet::ShellRule::kAutomatic)
      .value("FEWEST", bullet::ShellRule::kFewest);

  nb::enum_<ConstraintSolver>(module, "ConstraintSolver")
      .value("COULOMB", ConstraintSolver::kCoulomb)
      .value("SEQUENTIAL_IMPULSE", ConstraintSolver::kSequentialImpulse)
      .value("NNCG", ConstraintSolver::kNncg)
      .value("DANTZIG", ConstraintSolver::kDantzig)
      .value("PROJECTED_GAUSS_SEIDEL", ConstraintSolver::kProjectedGaussSeidel);

  nb::enum_<bullet::SolverEffort>(module, "SolverEffort")
      .value("FIXED", bullet::SolverEffort::kFixed)
      .value("AS_NEEDED", bullet::SolverEffort::kAsNeeded);

  nb::enum_<Motion>(module, "Motion")
      .value("DYNAMIC", Motion::kDynamic)
      .value("STATIC", Motion::kStatic)
      .value("KINEMATIC", Motion::kKinematic);

  nb::class_<BodyMaterial>(module, "BodyMaterial")
      .def(nb::init<>())
      .def_rw("friction", &BodyMaterial::friction)
      .def_rw("rolling_friction", &BodyMaterial::rolling_friction)
      .def_rw("spinning_friction", &BodyMaterial::spinning_friction)
      .def_rw("restitution", &BodyMaterial::restitution)
      .def_rw("linear_damping", &BodyMaterial::linear_damping)
      .def_rw("angular_damping", &BodyMaterial::angular_damping)
      .def_prop_rw(
          "surface_velocity",
          [](const BodyMaterial& material) { return to_coordinates(material.surface_velocity); },
          [](BodyMaterial& material, const Coordinates& velocity) {
            material.surface_velocity = to_vec3(velocity);
          })
      .def_rw("group", &BodyMaterial::group)
      .def_rw("mask", &BodyMaterial::mask);

  nb::class_<SimulationState>(module, "SimulationState")
      .def("to_rows", &read_rows)
      .def_static("from_rows", &write_rows);

  module.attr("most_turn") = Simulation::kMostTurn;
  module.attr("most_way") = Simulation::kMostWay;
  module.attr("most_extent") = Simulation::kMostExtent;
  module.attr("most_mass") = Simulation::kMostMass;

  nb::class_<SharedSimulation> simulation(module, "Simulation");
  simulation
      .def(
          "__init__",
          [](SharedSimulation* self, const Coordinates& gravity, double time_step, bool sleeping,
             double split_impulse_threshold, ConstraintSolver solver, int iterations,
             bullet::SolverEffort effort, bool two_friction_directions, bullet::ContactMode mode,
             bullet::ShellRule shell, int level, double margin, double ccd_motion_threshold,
             unsigned threads) {
            new (self) SharedSimulation(
                {.gravity = to_vec3(gravity),
                 .time_step = time_step,
                 .sleeping = sleeping,
                 .split_impulse_threshold = split_impulse_threshold,
                 .solver = solver,
                 .iterations = iterations,
                 .effort = effort,
                 .two_friction_directions = two_friction_directions,
                 .contact = {.mode = mode,
                             .shell = shell,
                             .level = level,
                             .margin = margin,
                             .ccd_motion_threshold = ccd_motion_threshold,
                             .rolling_at_rest = solver != ConstraintSolver::kNncg,
                             .solver_turns_contacts = solver == ConstraintSolver::kCoulomb},
                 .threads = threads});
          },
          nb::arg("gravity"), nb::arg("time_step"), nb::arg("sleeping"),
          nb::arg("split_impulse_threshold"), nb::arg("solver"), nb::arg("iterations"),
          nb::arg("effort"), nb::arg("two_friction_directions"), nb::arg("mode"), nb::arg("shell"),
          nb::arg("level"), nb::arg("margin"), nb::arg("ccd_motion_threshold"), nb::arg("threads"),
          InOrdinaryFloats())
      .def("step", &step, nb::arg("count"));
  SimulationMethods(simulation)
      .def(
          "add_body",
          [](Simulation& self, const Geometry& geometry, Motion motion, double mass,
             const Coordinates& center_of_mass, const std::array<Coordinates, 3>& inertia,
             const PoseMatrix& pose, const BodyMaterial& material) {
            return self.add_body({.geometry = geometry,
                                  .mass_properties = {mass,
                                                      to_vec3(center_of_mass),
                                                      {to_vec3(inertia[0]), to_vec3(inertia[1]),
                                                       to_vec3(inertia[2])}},
                                  .motion = motion,
                                  .world_from_geometry = to_pose(pose),
                                  .material = material});
          },
          nb::arg("geometry"), nb::arg("motion"), nb::arg("mass"), nb::arg("center_of_mass"),
          nb::arg("inertia"), nb::arg("pose"), nb::arg("material"))
      .def("remove_body", &Simulation::remove_body)
      .def("add_joint", &Simulation::add_joint)
      .def("remove_joint", &Simulation::remove_joint)
      .def("count_joint_turns_from", &Simulation::count_joint_turns_from)
      .def("read_joint", &Simulation::read_joint)
      .def("joint_reaction",
           [](const Simulation& s, std::size_t i) {
             const JointReaction reaction = s.joint_reaction(i);
             return std::pair(to_coordinates(reaction.force), to_coordinates(reaction.torque));
           })
      .def("motor", [](const Simulation& s, std::size_t i) { return Motor(s.motor(i)); })
      .def("set_motor", &Simulation::set_motor)
      .def("gravity", [](const Simulation& s) { return to_coordinates(s.gravity()); })
      .def("set_gravity",
           [](Simulation& s, const Coordinates& gravity) { s.set_gravity(to_vec3(gravity)); })
      .def("take_fast_spins", &Simulation::take_fast_spins)
      .def("take_long_ways", &Simulation::take_long_ways)
      .def("find_lost_body", &Simulation::find_lost_body)
      .def("timings", &timings)
      .def("clear_timings", &Simulation::clear_timings)
      .def("contacts", [](const Simulation& s) { return to_rows(s.compute_contacts()); })
      .def("find_contacts", [](Simulation& s, std::size_t a, std::size_t b,
                               double margin) { return to_rows(s.find_contacts(a, b, margin)); })
      .def("cast_rays", &cast_rays)
      .def("bounds",
           [](const Simulation& s, std::size_t i) {
             const Bounds bounds = s.bounds(i);
             return std::pair(to_coordinates(bounds.lower), to_coordinates(bounds.upper));
           })
      .def("pose",
           [](const Simulation& s, std::size_t i) { return to_matrix(s.world_from_geometry(i)); })
      .def("set_pose", [](Simulation& s, std::size_t i,
                          const PoseMatrix& pose) { s.set_world_from_geometry(i, to_pose(pose)); })
      .def("place",
           [](Simulation& s, std::size_t i, const PoseMatrix& pose) { s.place(i, to_pose(pose)); })
      .def("linear_velocity",
           [](const Simulation& s, std::size_t i) { return to_coordinates(s.linear_velocity(i)); })
      .def("angular_velocity",
           [](const Simulation& s, std::size_t i) { return to_coordinates(s.angular_velocity(i)); })
      .def("set_linear_velocity",
           [](Simulation& s, std::size_t i, const Coordinates& v) {
             s.set_linear_velocity(i, to_vec3(v));
           })
      .def("set_angular_velocity",
           [](Simulation& s, std::size_t i, const Coordinates& v) {
             s.set_angular_velocity(i, to_vec3(v));
           })
      .def("apply_force",
           [](Simulation& s, std::size_t i, const Coordinates& force,
              const std::optional<Coordinates>& place) {
             s.apply_force(i, to_vec3(force), to_place(place));
           })
      .def("apply_torque", [](Simulation& s, std::size_t i,
                              const Coordinates& torque) { s.apply_torque(i, to_vec3(torque)); })
      .def("apply_impulse",
           [](Simulation& s, std::size_t i, const Coordinates& impulse,
              const std::optional<Coordinates>& place) {
             s.apply_impulse(i, to_vec3(impulse), to_place(place));
           })
      .def("apply_torque_impulse",
           [](Simulation& s, std::size_t i, const Coordinates& impulse) {
             s.apply_torque_impulse(i, to_vec3(impulse));
           })
      .def("material",
           [](const Simulation& s, std::size_t i) { return BodyMaterial(s.material(i)); })
      .def("set_material", &Simulation::set_material)
      .def("set_collision", &Simulation::set_collision)
      .def("step_count", &Simulation::step_count)
      .def("save", &Simulation::save)
      .def("restore", &Simulation::restore)
      .def("adopt", &Simulation::adopt)
      .def("is_asleep", &Simulation::is_asleep)
      .def("wake", &Simulation::wake);
}

}  // namespace voxshell::python
