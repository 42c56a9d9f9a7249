#include "voxshell/wrench.h"

#include <algorithm>
#include <cstddef>

#include "query/posed.h"
#include "query/scratch.h"

namespace voxshell {

Wrench compute_wrench(const Field& field, const PointShell& shell, const Pose& field_from_shell,
                      double stiffness, QueryScratch& scratch) {
  const auto contacts = find_contacts(field, shell, field_from_shell, {}, scratch);
  QueryScratch::State& state = scratch.state();
  simd::PointList points = state.empty_points();
  // Edges have no area, and come behind the points.
  const auto first_edge = std::partition_point(
      contacts.begin(), contacts.end(), [&](const Contact& c) { return shell.is_point(c.id); });
  const auto of_points = contacts.first(static_cast<std::size_t>(first_edge - contacts.begin()));
  points.count = static_cast<std::uint32_t>(of_points.size());
  const auto* grid = std::get_if<GridField>(&field);
  const double step = 0.5 * (grid != nullptr ? grid->voxel_size() : shell.spacing());
  state.reserve_gradients();
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    simd::query_kernels<V>(simd::active_isa())
        .differentiate(posed, points, static_cast<float>(step), state.lists().gradient_x.get(),
                       state.lists().gradient_y.get(), state.lists().gradient_z.get());
  });
  Wrench wrench;
  for (std::size_t i = 0; i < of_points.size(); ++i) {
    const Contact& contact = of_points[i];
    const double weight = stiffness * static_cast<double>(shell.areas()[contact.id]) *
                          static_cast<double>(contact.depth);
    const Vec3f gradient{state.lists().gradient_x[i], state.lists().gradient_y[i],
                         state.lists().gradient_z[i]};
    const Vec3 force = weight * static_cast<Vec3>(gradient);
    wrench.force += force;
    wrench.torque += cross(static_cast<Vec3>(contact.point), force);
  }
  return wrench;
}

}  // namespace voxshell
