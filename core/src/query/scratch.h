#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include "simd/query_kernels.h"
#include "voxshell/contacts.h"

namespace voxshell {

/// The view of any field, or none.
template <class Variant>
struct ViewOf;
template <class... Fields>
struct ViewOf<std::variant<Fields...>> {
  using Any = std::variant<std::monostate, decltype(std::declval<const Fields&>().view())...>;
};

/// Arrays that grow to the largest shell asked about and are never filled in advance.
struct QueryScratch::State {
  template <class T>
  using Buffer = std::unique_ptr<T[]>;

  struct NodeBuffer {
    Buffer<std::uint32_t> index;
    Buffer<std::uint32_t> tag;
    Buffer<float> bound;

    simd::NodeList empty_list() const { return {index.get(), tag.get(), bound.get(), 0}; }
    /// The root alone.
    simd::NodeList start_list() const {
      index[0] = 0;
      tag[0] = 0;
      bound[0] = -std::numeric_limits<float>::infinity();
      return {index.get(), tag.get(), bound.get(), 1};
    }
  };

  /// Makes room for any query about a shell.
  void reserve(const PointShell& shell);

  /// Room for one point a segment.
  simd::FoundPoint* reserve_found(std::size_t segments);

  /// Room for one gradient a point.
  void reserve_gradients();

  simd::PointList empty_points() const {
    return {point_id.get(),
            point_tag.get(),
            point_distance.get(),
            point_x.get(),
            point_y.get(),
            point_z.get(),
            0};
  }
  Contact* contact_data() const { return reinterpret_cast<Contact*>(contact_bytes.get()); }

  std::size_t point_capacity = 0;
  std::size_t node_capacity = 0;
  NodeBuffer nodes[2];
  Buffer<std::uint32_t> point_id, point_tag;
  Buffer<float> point_distance, point_x, point_y, point_z;
  Buffer<std::byte> contact_bytes;
  std::size_t contact_count = 0;
  Buffer<simd::FoundPoint> found;  ///< one a segment
  std::size_t found_capacity = 0;
  Buffer<float> gradient_x, gradient_y, gradient_z;
  std::size_t gradient_capacity = 0;

  /// The slots that the last search for contacts was left with, and for which question.
  struct Survivors {
    ViewOf<Field>::Any field;  ///< none: there are no survivors to go on from
    std::uint64_t tree = 0;
    Pose field_from_shell;
    float margin = 0.0f;
    double growth = 0.0;  ///< they serve all poses that move no point by more than this, metres
    Pose last_asked;
    bool are_contacts_kept = false;  ///< those of last_asked are where they were written
    std::size_t max_points = 0;      ///< of those
    simd::NodeList slots{};
  } survivors;
};

}  // namespace voxshell
