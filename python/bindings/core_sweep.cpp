#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/tuple.h>

#include "arrays.h"
#include "build_watch.h"
#include "contact_set.h"
#include "core_module.h"
#include "errors.h"
#include "in_ordinary_floats.h"
#include "interpreter_lock.h"
#include "pose_arrays.h"
#include "posed_pair.h"
#include "query_scratch.h"
#include "voxshell/distance.h"
#include "voxshell/parallel.h"
#include "voxshell/sweep.h"

namespace nb = nanobind;

namespace voxshell::python {
namespace {

/// Default tolerance, as a fraction of the shortest side of the smaller body, and of the voxel
/// sizes of both models if they have no tolerance.
constexpr double kToleranceOfSide = 1e-3;
constexpr double kToleranceOfVoxel = 0.1;

struct PairMotion {
  RigidMotion a;
  RigidMotion b;

  const RigidMotion& of(PairBody body) const { return body == PairBody::kA ? a : b; }
  PairPose at(double fraction) const { return {a.at(fraction), b.at(fraction)}; }
};

struct PairSweep {
  double fraction;
  std::optional<ShellContact> nearest;
};

/// The shell to sweep, and the tolerance.
struct Question {
  Bodies bodies;
  Roles roles;
  float margin;
  double tolerance;
};

/// The error of a body's own surface, meters.
double tolerance_of(const Model* model) {
  if (model == nullptr) return 0.0;
  const double tolerance = model->settings().tolerance;
  return tolerance > 0.0 ? tolerance : kToleranceOfVoxel * model->grid().voxel_size();
}

Question make_question(const Field& field_a, const Model* model_a, const Field& field_b,
                       const Model* model_b, ShellChoice shells, float margin,
                       std::optional<double> tolerance) {
  const Bodies bodies{field_a, model_a, field_b, model_b};
  const Roles roles = choose_roles(bodies, shells);
  const double side = unwrap(decide_role(bodies.a, bodies.b, shells)).side;
  const double of_models = tolerance_of(model_a) + tolerance_of(model_b);
  return {bodies, roles, margin, tolerance.value_or(std::max(kToleranceOfSide * side, of_models))};
}

/// `scratch_of(body)` is the scratch for that body's shell.
template <class ScratchOf>
PairSweep sweep_pair(const Question& question, const PairMotion& motion,
                     const ScratchOf& scratch_of) {
  const Bodies& bodies = question.bodies;
  // With the shell of fewest points, the role may change between poses.
  const PairBody first = question.roles.shell_bodies[0];
  const bool asks_other = question.roles.shell_bodies.size() > 1 ||
                          (question.roles.may_swap && bodies.shell_of(other(first)) != nullptr);
  PairSweep result{1.0, std::nullopt};
  const auto ask = [&](PairBody body) {
    const SweepOptions options{
        .margin = question.margin, .tolerance = question.tolerance, .end = result.fraction};
    const auto scratch = scratch_of(body);
    const Sweep found = sweep(*bodies.field_of(other(body)), *bodies.shell_of(body),
                              motion.of(other(body)), motion.of(body), options, *scratch);
    if (!found.contact) return;
    const bool is_deeper = !result.nearest || found.fraction < result.fraction ||
                           found.contact->depth > result.nearest->contact.depth;
    result.fraction = found.fraction;
    if (is_deeper) result.nearest = ShellContact{body, *found.contact};
  };
  ask(first);
  if (asks_other) ask(other(first));
  if (result.fraction > 0.0 && question.roles.asks_inside) {
    // One body is inside the other at the start.
    const auto inside = find_inner_contacts(bodies, motion.at(0.0), question.margin);
    if (!inside.empty()) return {0.0, inside[0]};
  }
  if (result.nearest && asks_other) {
    // The shell that stops later, or never, may still be the nearer one.
    const PairBody body = other(result.nearest->shell_body);
    const auto scratch = scratch_of(body);
    const auto nearer = find_nearest(*bodies.field_of(other(body)), *bodies.shell_of(body),
                                     motion.at(result.fraction).field_from_shell(body),
                                     -result.nearest->contact.depth, *scratch);
    if (nearer) result.nearest = ShellContact{body, *nearer};
  }
  return result;
}

using Matrix = std::array<double, 16>;

Matrix write_matrix(const Pose& pose) {
  const Matrix3& r = pose.rotation;
  const Vec3& t = pose.translation;
  return {r.row_x.x, r.row_x.y, r.row_x.z, t.x, r.row_y.x, r.row_y.y, r.row_y.z, t.y,
          r.row_z.x, r.row_z.y, r.row_z.z, t.z, 0.0,       0.0,       0.0,       1.0};
}

using Numbers = nb::ndarray<nb::numpy, double>;

/// Fractions, distances, points on a and b, normals, shells (0: a's, 1: b's, -1: none), poses of a
/// and b.
using Sweeps = std::tuple<Numbers, Numbers, Numbers, Numbers, Numbers,
                          nb::ndarray<nb::numpy, std::int64_t>, Numbers, Numbers>;

/// An array of the shape of vectors or matrices.
template <class Item>
Numbers release_numbers(const std::vector<Item>& items, std::initializer_list<std::size_t> shape) {
  static_assert(sizeof(Item) % sizeof(double) == 0);
  const auto* const first = reinterpret_cast<const double*>(items.data());
  const std::size_t count = items.size() * (sizeof(Item) / sizeof(double));
  return release<double>(std::vector<double>(first, first + count), shape);
}

/// Sweeps as parallel arrays, in the world frame. If nothing touches: an infinite distance, points
/// and normals of NaN, and no shell.
class SweepArrays {
 public:
  explicit SweepArrays(std::size_t count)
      : fractions_(count),
        distances_(count),
        points_a_(count),
        points_b_(count),
        normals_(count),
        shells_(count),
        a_poses_(count),
        b_poses_(count) {}

  void set(std::size_t i, const PairMotion& motion, const PairSweep& swept) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const PairPose pose = motion.at(swept.fraction);
    fractions_[i] = swept.fraction;
    a_poses_[i] = write_matrix(pose.world_from_a);
    b_poses_[i] = write_matrix(pose.world_from_b);
    WorldContact world{{kNone, kNone, kNone}, {kNone, kNone, kNone}, {kNone, kNone, kNone}};
    distances_[i] = std::numeric_limits<double>::infinity();
    shells_[i] = kNoShell;
    if (const auto& nearest = swept.nearest) {
      world = to_world(nearest->contact, nearest->shell_body, pose);
      distances_[i] = 0.0 - static_cast<double>(nearest->contact.depth);
      shells_[i] = nearest->shell_body == PairBody::kA ? 0 : 1;
    }
    points_a_[i] = world.point_a;
    points_b_[i] = world.point_b;
    normals_[i] = world.normal;
  }

  Sweeps release_all() {
    const std::size_t count = fractions_.size();
    return {release<double>(std::move(fractions_), {count}),
            release<double>(std::move(distances_), {count}),
            release_numbers(points_a_, {count, 3}),
            release_numbers(points_b_, {count, 3}),
            release_numbers(normals_, {count, 3}),
            release<std::int64_t>(std::move(shells_), {count}),
            release_numbers(a_poses_, {count, 4, 4}),
            release_numbers(b_poses_, {count, 4, 4})};
  }

 private:
  static constexpr std::int64_t kNoShell = -1;

  std::vector<double> fractions_;
  std::vector<double> distances_;
  std::vector<Vec3> points_a_;
  std::vector<Vec3> points_b_;
  std::vector<Vec3> normals_;
  std::vector<std::int64_t> shells_;  ///< 0: a's shell, 1: b's shell
  std::vector<Matrix> a_poses_;
  std::vector<Matrix> b_poses_;
};

Sweeps sweep_one(const Field& field_a, const Model* model_a, const Field& field_b,
                 const Model* model_b, const OptionalPose& a_pose, const OptionalPose& a_end,
                 const OptionalPose& b_pose, const OptionalPose& b_end, ShellChoice shells,
                 RoundedInside margin, std::optional<double> tolerance, SharedScratch* scratch) {
  const auto read_motion = [](const OptionalPose& start, const char* start_name,
                              const OptionalPose& end, const char* end_name) {
    const Pose from = read_pose(start, start_name);
    return end ? RigidMotion::between(from, read_pose(end, end_name)) : RigidMotion{from, {}, {}};
  };
  const PairMotion motion{read_motion(a_pose, "a_pose", a_end, "a_end"),
                          read_motion(b_pose, "b_pose", b_end, "b_end")};
  const Question question =
      make_question(field_a, model_a, field_b, model_b, shells, margin, tolerance);
  SweepArrays arrays(1);
  {
    const ReleasedInterpreter released;
    arrays.set(0, motion, sweep_pair(question, motion, [&](PairBody body) {
                 return LockedScratch(scratch, body);
               }));
  }
  return arrays.release_all();
}

Sweeps sweep_batch(const Field& field_a, const Model* model_a, const Field& field_b,
                   const Model* model_b, std::size_t count, const OptionalPoses& a_poses,
                   const OptionalPoses& a_ends, const OptionalPoses& b_poses,
                   const OptionalPoses& b_ends, ShellChoice shells, RoundedInside margin,
                   std::optional<double> tolerance, unsigned threads, nb::handle progress) {
  const std::vector<Pose> a_starts = read_poses(a_poses, count, "a_poses");
  const std::vector<Pose> b_starts = read_poses(b_poses, count, "b_poses");
  const std::vector<Pose> a_last = a_ends ? read_poses(a_ends, count, "a_ends") : a_starts;
  const std::vector<Pose> b_last = b_ends ? read_poses(b_ends, count, "b_ends") : b_starts;
  const Question question =
      make_question(field_a, model_a, field_b, model_b, shells, margin, tolerance);
  SweepArrays arrays(count);
  BuildWatch watch(progress);
  {
    const ReleasedInterpreter released;
    constexpr std::size_t kMotionsPerTask = 16;
    const auto report = [&](std::string_view stage, double fraction) {
      return watch.report(stage, fraction);
    };
    const auto sweep_range = [&](std::size_t begin, std::size_t end) {
      std::array<QueryScratch, 2> scratches;
      for (std::size_t i = begin; i < end; ++i) {
        const PairMotion motion{RigidMotion::between(a_starts[i], a_last[i]),
                                RigidMotion::between(b_starts[i], b_last[i])};
        arrays.set(i, motion, sweep_pair(question, motion, [&](PairBody body) {
                     return &scratches[body == PairBody::kA ? 0 : 1];
                   }));
      }
    };
    parallel_for_ranges(count, kMotionsPerTask, threads, "sweeps", report, sweep_range);
  }
  watch.rethrow();
  return arrays.release_all();
}

Numbers interpolate(
    const OptionalPose& start, const OptionalPose& end,
    const nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>& at) {
  const RigidMotion motion = RigidMotion::between(read_pose(start, "start"), read_pose(end, "end"));
  std::vector<Matrix> matrices;
  matrices.reserve(at.shape(0));
  for (std::size_t i = 0; i < at.shape(0); ++i) {
    matrices.push_back(write_matrix(motion.at(at.data()[i])));
  }
  return release_numbers(matrices, {at.shape(0), 4, 4});
}

}  // namespace

void bind_sweep(nb::module_& module) {
  module.def("sweep", &sweep_one, nb::arg("field_a"), nb::arg("model_a").none(), nb::arg("field_b"),
             nb::arg("model_b").none(), nb::arg("a_pose").none(), nb::arg("a_end").none(),
             nb::arg("b_pose").none(), nb::arg("b_end").none(), nb::arg("shells"),
             nb::arg("margin"), nb::arg("tolerance").none(), nb::arg("scratch").none(),
             InOrdinaryFloats(),
             "Call sweep_batch() for one motion. Without an end, a body does not move.");
  module.def("sweep_batch", &sweep_batch, nb::arg("field_a"), nb::arg("model_a").none(),
             nb::arg("field_b"), nb::arg("model_b").none(), nb::arg("count"),
             nb::arg("a_poses").none(), nb::arg("a_ends").none(), nb::arg("b_poses").none(),
             nb::arg("b_ends").none(), nb::arg("shells"), nb::arg("margin"),
             nb::arg("tolerance").none(), nb::arg("threads"), nb::arg("progress").none(),
             InOrdinaryFloats(),
             "Return fractions, distances, points on a and b, normals, shells (0: a's, 1: b's, "
             "-1: none), and poses of a and b.");
  module.def("interpolate", &interpolate, nb::arg("start").none(), nb::arg("end").none(),
             nb::arg("at"), InOrdinaryFloats(), "Return (k, 4, 4) poses.");
}

}  // namespace voxshell::python
