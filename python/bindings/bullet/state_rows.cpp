#include "bullet/state_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace voxshell::python {
namespace {

using BodyState = SimulationState::BodyState;
using JointState = SimulationState::JointState;

/// How far rows of a rotation may be from orthonormal.
constexpr double kRigidTolerance = 1e-6;

/// The numbers of a state's row that holds no item.
struct Whole {
  double step_count = 0.0;
  Vec3 gravity;
};

struct Pair {
  int a = 0;
  int b = 0;
};

struct ManifoldHead {
  int body_0 = 0;
  int body_1 = 0;
  int count = 0;  ///< of its points
};

class Writer {
 public:
  explicit Writer(std::vector<double>& numbers) : numbers_(numbers) {}
  template <class T>
  void number(T& value) {
    numbers_.push_back(static_cast<double>(value));
  }

 private:
  std::vector<double>& numbers_;
};

class Reader {
 public:
  explicit Reader(const double* numbers) : next_(numbers) {}
  template <class T>
  void number(T& value) {
    const double read = *next_++;
    if (!std::isfinite(read)) throw std::invalid_argument("it has a number that is not finite");
    if constexpr (!std::is_floating_point_v<T>) {
      if (read != std::floor(read) || std::abs(read) > std::numeric_limits<int>::max()) {
        throw std::invalid_argument("it has a number that must be an integer and is not");
      }
    }
    value = static_cast<T>(read);
  }

 private:
  const double* next_;
};

// Each of these functions both writes and reads, so that the order of numbers is stated once.

template <class Archive>
void visit(Archive& archive, Vec3& v) {
  archive.number(v.x);
  archive.number(v.y);
  archive.number(v.z);
}

template <class Archive>
void visit(Archive& archive, btVector3& v) {
  for (int i = 0; i < 3; ++i) archive.number(v.m_floats[i]);
}

template <class Archive>
void visit(Archive& archive, btTransform& pose) {
  for (int row = 0; row < 3; ++row) visit(archive, pose.getBasis()[row]);
  visit(archive, pose.getOrigin());
}

template <class Archive>
void visit(Archive& archive, Whole& whole) {
  archive.number(whole.step_count);
  visit(archive, whole.gravity);
}

template <class Archive>
void visit(Archive& archive, BodyMaterial& material) {
  for (double* value :
       {&material.friction, &material.rolling_friction, &material.spinning_friction,
        &material.restitution, &material.linear_damping, &material.angular_damping}) {
    archive.number(*value);
  }
  visit(archive, material.surface_velocity);
  archive.number(material.group);
  archive.number(material.mask);
}

template <class Archive>
void visit(Archive& archive, BodyState& body) {
  visit(archive, body.world_from_body);
  visit(archive, body.interpolated_world_from_body);
  for (btVector3* vector :
       {&body.linear_velocity, &body.angular_velocity, &body.interpolated_linear_velocity,
        &body.interpolated_angular_velocity, &body.force, &body.torque}) {
    visit(archive, *vector);
  }
  archive.number(body.activation);
  archive.number(body.still_for);
  visit(archive, body.material);
}

/// A speed without a limit is infinite, and -1 in rows.
template <class Archive>
void visit(Archive& archive, JointState& joint) {
  Motor& motor = joint.motor;
  int mode = static_cast<int>(motor.mode);
  double max_speed = std::isinf(motor.max_speed) ? -1.0 : motor.max_speed;
  archive.number(mode);
  archive.number(motor.target);
  archive.number(motor.max_force);
  archive.number(max_speed);
  archive.number(motor.leader);
  archive.number(motor.multiplier);
  archive.number(motor.velocity);
  if (mode < 0 || mode > static_cast<int>(MotorMode::kFollow)) {
    throw std::invalid_argument("it has a motor of an unknown mode");
  }
  motor.mode = static_cast<MotorMode>(mode);
  motor.max_speed = max_speed < 0.0 ? std::numeric_limits<double>::infinity() : max_speed;
  archive.number(joint.last_step.position);
  btJointFeedback& feedback = joint.last_step.feedback;
  for (btVector3* vector : {&feedback.m_appliedForceBodyA, &feedback.m_appliedTorqueBodyA,
                            &feedback.m_appliedForceBodyB, &feedback.m_appliedTorqueBodyB}) {
    visit(archive, *vector);
  }
}

template <class Archive>
void visit(Archive& archive, Pair& pair) {
  archive.number(pair.a);
  archive.number(pair.b);
}

template <class Archive>
void visit(Archive& archive, ManifoldHead& head) {
  archive.number(head.body_0);
  archive.number(head.body_1);
  archive.number(head.count);
}

/// All but the pointer that is the user's.
template <class Archive>
void visit(Archive& archive, btManifoldPoint& point) {
  for (btVector3* vector : {&point.m_localPointA, &point.m_localPointB, &point.m_positionWorldOnB,
                            &point.m_positionWorldOnA, &point.m_normalWorldOnB,
                            &point.m_lateralFrictionDir1, &point.m_lateralFrictionDir2}) {
    visit(archive, *vector);
  }
  for (btScalar* value :
       {&point.m_distance1, &point.m_combinedFriction, &point.m_combinedRollingFriction,
        &point.m_combinedSpinningFriction, &point.m_combinedRestitution, &point.m_appliedImpulse,
        &point.m_prevRHS, &point.m_appliedImpulseLateral1, &point.m_appliedImpulseLateral2,
        &point.m_contactMotion1, &point.m_contactMotion2, &point.m_contactCFM, &point.m_contactERP,
        &point.m_frictionCFM}) {
    archive.number(*value);
  }
  for (int* value : {&point.m_partId0, &point.m_partId1, &point.m_index0, &point.m_index1,
                     &point.m_contactPointFlags, &point.m_lifeTime}) {
    archive.number(*value);
  }
}

template <class Archive>
void visit(Archive& archive, SimulationContact& contact) {
  for (int* value : {&contact.body_a, &contact.body_b, &contact.id}) archive.number(*value);
  for (Vec3* vector : {&contact.point_a, &contact.point_b, &contact.normal}) {
    visit(archive, *vector);
  }
  archive.number(contact.depth);
  archive.number(contact.impulse);
  visit(archive, contact.friction);
}

template <class Item>
std::size_t count_columns() {
  std::vector<double> row;
  Writer writer(row);
  Item item{};
  visit(writer, item);
  return row.size();
}

template <class Item>
void append(NumberTable& table, Item item) {
  Writer writer(table.numbers);
  visit(writer, item);
}

template <class Item>
std::vector<Item> read_items(const NumberTable& table) {
  const std::size_t columns = count_columns<Item>();
  if (table.columns != columns) {
    throw std::invalid_argument("it has rows of " + std::to_string(table.columns) +
                                " numbers instead of " + std::to_string(columns));
  }
  std::vector<Item> items(table.numbers.size() / columns);
  for (std::size_t i = 0; i < items.size(); ++i) {
    Reader reader(table.numbers.data() + i * columns);
    visit(reader, items[i]);
  }
  return items;
}

void check_rigid(const btTransform& pose) {
  const btMatrix3x3& basis = pose.getBasis();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      if (std::abs(basis[i].dot(basis[j]) - (i == j ? 1.0 : 0.0)) > kRigidTolerance) {
        throw std::invalid_argument("it has a pose that is not rigid");
      }
    }
  }
  if (basis.determinant() < 0) throw std::invalid_argument("it has a pose that mirrors");
}

/// Refuses places of bodies or joints that do not exist.
void check_places(std::initializer_list<int> places, std::size_t count) {
  for (const int place : places) {
    if (place < 0 || static_cast<std::size_t>(place) >= count) {
      throw std::invalid_argument("it names body or joint " + std::to_string(place) + " of " +
                                  std::to_string(count));
    }
  }
}

void check(const SimulationState& state) {
  for (const BodyState& body : state.bodies) {
    check_rigid(body.world_from_body);
    check_rigid(body.interpolated_world_from_body);
    if (body.activation < ACTIVE_TAG || body.activation > DISABLE_SIMULATION) {
      throw std::invalid_argument("it has a body that neither sleeps nor is awake");
    }
  }
  for (const JointState& joint : state.joints) {
    if (joint.motor.mode == MotorMode::kFollow) {
      check_places({joint.motor.leader}, state.joints.size());
    }
  }
  for (const auto& [a, b] : state.apart) check_places({a, b}, state.bodies.size());
  for (const auto& manifold : state.manifolds) {
    check_places({manifold.body_0, manifold.body_1}, state.bodies.size());
  }
  for (const SimulationContact& contact : state.contacts) {
    check_places({contact.body_a, contact.body_b}, state.bodies.size());
  }
}

std::vector<std::size_t> count_up(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

template <class Parts>
std::map<int, int> map_numbers(const Parts& parts, const std::vector<std::size_t>& numbers) {
  if (parts.size() != numbers.size()) {
    throw std::out_of_range("the world has other bodies or joints than the state");
  }
  std::map<int, int> mapped;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    mapped[static_cast<int>(parts[i].number)] = static_cast<int>(numbers[i]);
  }
  return mapped;
}

}  // namespace

StateRows to_rows(const SimulationState& state) {
  const auto own = renumber(state, count_up(state.bodies.size()), count_up(state.joints.size()));
  StateRows rows{{count_columns<Whole>(), {}},
                 {count_columns<BodyState>(), {}},
                 {count_columns<JointState>(), {}},
                 {count_columns<Pair>(), {}},
                 {count_columns<ManifoldHead>(), {}},
                 {count_columns<btManifoldPoint>(), {}},
                 {count_columns<SimulationContact>(), {}}};
  append(rows.whole, Whole{static_cast<double>(own->step_count), own->gravity});
  for (const BodyState& body : own->bodies) append(rows.bodies, body);
  for (const JointState& joint : own->joints) append(rows.joints, joint);
  for (const auto& [a, b] : own->apart) append(rows.apart, Pair{a, b});
  for (const auto& manifold : own->manifolds) {
    append(rows.manifolds, ManifoldHead{manifold.body_0, manifold.body_1,
                                        static_cast<int>(manifold.points.size())});
    for (const btManifoldPoint& point : manifold.points) append(rows.points, point);
  }
  for (const SimulationContact& contact : own->contacts) append(rows.contacts, contact);
  return rows;
}

std::shared_ptr<const SimulationState> from_rows(const StateRows& rows) {
  auto state = std::make_shared<SimulationState>();
  const std::vector<Whole> whole = read_items<Whole>(rows.whole);
  if (whole.size() != 1) throw std::invalid_argument("it does not have one number of steps");
  constexpr double kMostSteps = 9007199254740992.0;  // 2^53
  const double steps = whole[0].step_count;
  if (steps < 0.0 || steps > kMostSteps || steps != std::floor(steps)) {
    throw std::invalid_argument("it has a number of steps that no world can have");
  }
  state->step_count = static_cast<std::uint64_t>(steps);
  state->gravity = whole[0].gravity;
  state->bodies = read_items<BodyState>(rows.bodies);
  state->joints = read_items<JointState>(rows.joints);
  for (std::size_t i = 0; i < state->bodies.size(); ++i) state->bodies[i].number = i;
  for (std::size_t i = 0; i < state->joints.size(); ++i) state->joints[i].number = i;
  for (const Pair& pair : read_items<Pair>(rows.apart)) state->apart.insert({pair.a, pair.b});
  const std::vector<btManifoldPoint> points = read_items<btManifoldPoint>(rows.points);
  auto next = points.begin();
  for (const ManifoldHead& head : read_items<ManifoldHead>(rows.manifolds)) {
    if (head.count < 0 || head.count > points.end() - next) {
      throw std::invalid_argument("it has fewer points than its manifolds");
    }
    state->manifolds.push_back({head.body_0, head.body_1, {next, next + head.count}});
    next += head.count;
  }
  state->contacts = read_items<SimulationContact>(rows.contacts);
  check(*state);
  return state;
}

std::shared_ptr<SimulationState> renumber(const SimulationState& state,
                                          const std::vector<std::size_t>& bodies,
                                          const std::vector<std::size_t>& joints) {
  const std::map<int, int> of_body = map_numbers(state.bodies, bodies);
  const std::map<int, int> of_joint = map_numbers(state.joints, joints);
  auto other = std::make_shared<SimulationState>(state);
  for (std::size_t i = 0; i < bodies.size(); ++i) other->bodies[i].number = bodies[i];
  for (std::size_t i = 0; i < joints.size(); ++i) other->joints[i].number = joints[i];
  for (JointState& joint : other->joints) {
    if (joint.motor.mode == MotorMode::kFollow) {
      joint.motor.leader = of_joint.at(joint.motor.leader);
    }
  }
  // Bodies that have been removed may have left pairs and contacts behind.
  const auto knows = [&](int a, int b) { return of_body.contains(a) && of_body.contains(b); };
  other->apart.clear();
  for (const auto& [a, b] : state.apart) {
    if (knows(a, b)) other->apart.insert({of_body.at(a), of_body.at(b)});
  }
  std::erase_if(other->contacts, [&](const auto& it) { return !knows(it.body_a, it.body_b); });
  for (SimulationContact& contact : other->contacts) {
    contact.body_a = of_body.at(contact.body_a);
    contact.body_b = of_body.at(contact.body_b);
  }
  std::erase_if(other->manifolds, [&](const auto& it) { return !knows(it.body_0, it.body_1); });
  for (auto& manifold : other->manifolds) {
    manifold.body_0 = of_body.at(manifold.body_0);
    manifold.body_1 = of_body.at(manifold.body_1);
    for (btManifoldPoint& point : manifold.points) point.m_userPersistentData = nullptr;
  }
  return other;
}

}  // namespace voxshell::python
