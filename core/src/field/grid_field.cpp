#include "voxshell/grid_field.h"

#include <cmath>
#include <memory>
#include <utility>

#include "base/serial.h"
#include "field/brick_entry.h"
#include "simd/exact_view.h"
#include "simd/grid_formula.h"
#include "simd/grid_sampling.h"

namespace voxshell {

using simd::kBrickCells;

namespace {

using Row = float[8];

const Row* to_rows(const EightPoints& points) {
  static_assert(sizeof(EightPoints) == 3 * sizeof(Row));
  return reinterpret_cast<const Row*>(points.coordinates.data());
}

simd::portable::Triple<float> to_triple(const Vec3f& p) { return {p.x, p.y, p.z}; }

simd::ExactGridView view_of(const GridFieldData& data, std::uint64_t serial) {
  simd::ExactGridView view{};
  view.serial = serial;
  view.entries = data.entries.data();
  view.samples = data.samples.data();
  view.planes = data.planes.data();
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = kBrickCells * data.bricks[static_cast<std::size_t>(axis)];
    view.origin[axis] = static_cast<float>(data.origin[axis]);
    view.cells[axis] = static_cast<float>(cells);
    view.last_brick[axis] = data.bricks[static_cast<std::size_t>(axis)] - 1;
  }
  view.bricks_x = data.bricks[0];
  view.bricks_xy = data.bricks[0] * data.bricks[1];
  for (int level = 0; level < 4; ++level) {
    const auto [row, layer] = BrickEntry{.cells = 1 << level}.strides(data.bricks);
    view.rows[level] = static_cast<int>(row);
    view.layers[level] = static_cast<int>(layer);
  }
  view.voxel_size = static_cast<float>(data.voxel_size);
  view.inverse_voxel_size = static_cast<float>(1.0 / data.voxel_size);
  view.quantum = static_cast<float>(data.voxel_size / data.quanta_per_voxel);
  view.node_error = static_cast<float>(data.node_error);
  view.fine_error = static_cast<float>(std::sqrt(0.75) * data.voxel_size + data.node_error);
  view.spread = static_cast<float>(0.75 * data.voxel_size * data.voxel_size);
  view.gap = static_cast<float>(data.gap());
  view.plane_margin = static_cast<float>(data.plane_margin());
  for (std::size_t i = 0; i < data.coarse_floors.size(); ++i) {
    view.coarse_floors[i] = static_cast<float>(data.coarse_floors[i]);
  }
  view.exact_bricks = data.exact.bricks.data();
  view.exact_masks = data.exact.masks.data();
  view.exact_lists = data.exact.lists.data();
  view.listed = data.exact.listed.data();
  view.triangles = data.exact.triangles.data();
  view.feature_normals = data.exact.feature_normals.data();
  return view;
}

}  // namespace

GridField::GridField(GridFieldData data) : GridField(std::move(data), next_serial()) {}

GridField::GridField(GridFieldData data, std::uint64_t serial)
    : data_(std::move(data)),
      view_(std::make_unique<const simd::ExactGridView>(view_of(data_, serial))) {}

GridField::GridField(const GridField& other) : GridField(other.data_, other.view_->serial) {}
GridField& GridField::operator=(const GridField& other) { return *this = GridField(other); }

// Moved vectors keep their elements where they are, so the view holds.
GridField::GridField(GridField&& other) noexcept = default;
GridField& GridField::operator=(GridField&& other) noexcept = default;
GridField::~GridField() = default;

std::array<int, 3> GridField::shape() const {
  const auto [x, y, z] = data_.bricks;
  return {kBrickCells * x + 1, kBrickCells * y + 1, kBrickCells * z + 1};
}

std::size_t GridField::nbytes() const {
  return sizeof(std::uint32_t) * data_.entries.size() +
         sizeof(std::int16_t) * data_.samples.size() + sizeof(float) * data_.planes.size() +
         data_.exact.nbytes();
}

template <class Visit>
auto GridField::with_view(const Visit& visit) const {
  return has_exact_cells() ? visit(exact_view()) : visit(view());
}

const simd::GridView& GridField::view() const { return *view_; }

float GridField::distance(const Vec3f& p) const {
  return with_view([&]<class G>(const G& grid) {
    return simd::grid_sampling<G>().measure_distance(grid, &p.x);
  });
}

Vec3f GridField::gradient(const Vec3f& p) const {
  Vec3f gradient;
  with_view([&]<class G>(const G& grid) {
    simd::grid_sampling<G>().measure_gradient(grid, &p.x, &gradient.x);
  });
  return gradient;
}

float GridField::lower_bound(const Vec3f& center, float radius) const {
  return with_view([&](const auto& grid) {
    return simd::portable::evaluate_lower_bound(grid, to_triple(center), radius);
  });
}

EightFloats GridField::distances(const EightPoints& points) const {
  EightFloats distances;
  with_view([&]<class G>(const G& grid) {
    simd::grid_sampling<G>().measure_distances(grid, to_rows(points), distances.data());
  });
  return distances;
}

GridField::BallValues GridField::bound_balls(const EightPoints& centers,
                                             const EightFloats& radii) const {
  BallValues values;
  with_view([&]<class G>(const G& grid) {
    simd::grid_sampling<G>().bound_balls(grid, to_rows(centers), radii.data(),
                                         values.distance.data(), values.lower_bound.data());
  });
  return values;
}

double GridField::reach() const {
  const auto [x, y, z] = shape();
  const Vec3 far = data_.origin + data_.voxel_size * Vec3{1.0 * x, 1.0 * y, 1.0 * z};
  return length(data_.origin) + length(far);
}

}  // namespace voxshell
