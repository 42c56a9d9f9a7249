#include "model/measure_accuracy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "mesh/box_finder.h"
#include "mesh/box_hierarchy.h"
#include "mesh/closest_point.h"
#include "mesh/edges.h"
#include "mesh/surface_places.h"
#include "model/normal_cone.h"
#include "model/shell_elements.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

constexpr std::size_t kMostVertices = 16'384;
constexpr std::size_t kEdgePlaces = 24'576;
constexpr std::size_t kLeastPlaces = 100'000;
/// More of them where some will be left out.
constexpr std::size_t kPlacesForHidden = 25'000;
constexpr std::size_t kTask = 1024;  // places
/// Places near one another for which the elements around are looked up together.
constexpr std::size_t kGroup = 4;

/// Convex edges that turn by more than 20 degrees are sharp: chord of their normals.
constexpr double kSharpChord = 0.3472963553338607;
/// Normals are looked for around a place that is pushed into the body, because gradients are
/// ambiguous on creases: by this fraction of a cell, of the thickness, and of the height of the
/// triangles around, whichever is least.
constexpr double kPushedCells = 0.25;
constexpr double kPushedThickness = 0.05;
constexpr double kPushedHeight = 0.05;
constexpr double kLeastPush = 4e-6;  // of the largest coordinate, so that float32 resolves it
/// Surfaces farther away than the nearest by up to this fraction of the push count as nearest, too.
constexpr double kNearestSlack = 0.05;
/// Of the triangles around a corner, at most this many are looked at.
constexpr std::size_t kMostAround = 24;

/// The mesh, and what is around its triangles, edges and vertices.
class Surroundings {
 public:
  explicit Surroundings(const TriangleMesh& mesh)
      : mesh_(mesh),
        edges_(find_edges(mesh)),
        stars_(mesh),
        normals_(mesh.triangles().size()),
        heights_(normals_.size()),
        across_(normals_.size(), {kNoTriangle, kNoTriangle, kNoTriangle}),
        areas_(normals_.size()) {
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      const Vec3 doubled = cross(b - a, c - a);
      const double area = length(doubled);
      const double longest = std::sqrt(
          std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)}));
      areas_[i] = area;
      if (area > 0.0) normals_[i] = doubled / area;
      heights_[i] = area / longest;
    }
    for (const MeshEdge& edge : edges_) {
      if (edge.second == kNoTriangle) continue;
      across_[edge.first][side_of(edge.first, edge)] = edge.second;
      across_[edge.second][side_of(edge.second, edge)] = edge.first;
    }
  }

  const TriangleMesh& mesh() const { return mesh_; }
  const std::vector<MeshEdge>& edges() const { return edges_; }
  std::span<const std::uint32_t> star(std::uint32_t vertex) const { return stars_[vertex]; }
  /// Of a triangle; 0 where it has no area.
  const Vec3& normal(std::uint32_t triangle) const { return normals_[triangle]; }
  double height(std::uint32_t triangle) const { return heights_[triangle]; }  ///< the least
  double doubled_area(std::uint32_t triangle) const { return areas_[triangle]; }
  /// The triangle across side i, from corner i to the next; or kNoTriangle.
  std::uint32_t across(std::uint32_t triangle, std::size_t side) const {
    return across_[triangle][side];
  }

  double edge_length(const MeshEdge& edge) const {
    return length(mesh_.vertices()[edge.high] - mesh_.vertices()[edge.low]);
  }

  /// Of the normals beside an edge; negative where the edge is not convex.
  double convex_chord(const MeshEdge& edge) const {
    if (edge.second == kNoTriangle) return -1.0;
    const Vec3& first = normals_[edge.first];
    const Vec3& second = normals_[edge.second];
    if (first == Vec3{} || second == Vec3{}) return -1.0;
    Vec3 apex{};
    for (const std::uint32_t vertex : mesh_.triangles()[edge.second]) {
      if (vertex != edge.low && vertex != edge.high) apex = mesh_.vertices()[vertex];
    }
    const bool is_convex = dot(first, apex - mesh_.vertices()[edge.low]) < 0.0;
    return is_convex ? length(second - first) : -1.0;
  }

  /// Weighted so that it does not change with the triangulation of the faces around (Max 1999).
  Vec3 vertex_normal(std::uint32_t vertex) const {
    Vec3 sum{};
    const Vec3& at = mesh_.vertices()[vertex];
    for (const std::uint32_t triangle : star(vertex)) {
      double scale = areas_[triangle];
      for (const std::uint32_t corner : mesh_.triangles()[triangle]) {
        if (corner != vertex) scale /= squared_length(mesh_.vertices()[corner] - at);
      }
      sum += scale * normals_[triangle];
    }
    return normalized(sum);
  }

 private:
  std::size_t side_of(std::uint32_t triangle, const MeshEdge& edge) const {
    const Triangle& t = mesh_.triangles()[triangle];
    for (std::size_t side = 0; side < 2; ++side) {
      if (std::min(t[side], t[side + 1]) == edge.low &&
          std::max(t[side], t[side + 1]) == edge.high) {
        return side;
      }
    }
    return 2;
  }

  const TriangleMesh& mesh_;
  std::vector<MeshEdge> edges_;
  VertexStars stars_;
  std::vector<Vec3> normals_;
  std::vector<double> heights_;
  std::vector<std::array<std::uint32_t, 3>> across_;
  std::vector<double> areas_;
};

/// A place of the surface, where it faces, and the triangles that it and what is close by lie on.
struct Place {
  Vec3 point;
  Vec3 normal;  ///< 0 where the surface faces nowhere
  double push = 0.0;
  std::vector<std::uint32_t> own;     ///< triangles that it lies on
  std::vector<std::uint32_t> around;  ///< more that may be as near once it is pushed in
};

class Measurement {
 public:
  Measurement(const TriangleMesh& mesh, const VisibleSurface* visible, const GridField& field,
              const AccuracySettings& settings)
      : around_(mesh), visible_(visible), field_(field), settings_(settings) {
    const Bounds& bounds = mesh.bounds();
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
    }
    least_push_ = kLeastPush * farthest;
    most_push_ = std::min(kPushedCells * field.voxel_size(), kPushedThickness * settings.thickness);
    may_be_flipped_ = field.sign_report().method != SignMethod::kClosed;
    if (visible_ != nullptr) pieces_.emplace(bound_triangles(visible_->mesh));
    choose_places();
  }

  Accuracy run(PointShell& shell) {
    const std::size_t count = places();
    distances_.assign(count, kLeftOut);
    chords_.assign(count, kLeftOut);
    points_.assign(count, {});
    for_tasks(count, [&](std::size_t begin, std::size_t end) { measure_field(begin, end); });
    order_places();
    heights_.assign(count, kLeftOut);
    gaps_.assign(count, 0.0f);
    measure_shell(shell, nullptr);
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Bounds> added = add_points(shell);
      if (added.empty()) break;
      const BoxFinder finder(added);
      measure_shell(shell, &finder);
    }

    Accuracy accuracy;
    accuracy.distance = summarize(distances_);
    accuracy.places = distances_.size();
    accuracy.normal = summarize(chords_);
    for (double* chord : {&accuracy.normal.median, &accuracy.normal.p99, &accuracy.normal.worst}) {
      *chord = angle_of_chord(*chord);
    }
    accuracy.coverage = summarize(heights_);
    accuracy.gap = static_cast<double>(*std::ranges::max_element(gaps_));
    accuracy.is_sharp = is_sharp_;
    accuracy.curvature = curvature_;
    return accuracy;
  }

 private:
  static constexpr float kLeftOut = -1.0f;
  /// How often points are added, and at most how many.
  static constexpr int kRounds = 4;
  static constexpr std::size_t kMostAdded = 2'000;
  /// A place waits for the next round if it is nearer to a new point than this fraction of that
  /// point's distance from the points before.
  static constexpr float kNextTo = 0.5f;
  static constexpr float kSameWay = 0.8f;  // cosine

  std::size_t places() const { return vertices_.size() + edges_.size() + faces_.size(); }

  template <class Visit>
  void for_tasks(std::size_t count, const Visit& visit) const {
    parallel_for(
        (count + kTask - 1) / kTask, settings_.threads, "accuracy", {},
        [&](std::size_t task) { visit(task * kTask, std::min((task + 1) * kTask, count)); });
  }

  void choose_places() {
    const TriangleMesh& mesh = around_.mesh();
    const std::vector<MeshEdge>& edges = around_.edges();
    std::vector<double> lengths(edges.size());
    std::vector<double> sharp_lengths(edges.size(), 0.0);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      lengths[i] = around_.edge_length(edges[i]);
      const double chord = around_.convex_chord(edges[i]);
      if (chord > kSharpChord) {
        sharp_lengths[i] = lengths[i];
        is_sharp_ = true;
      } else if (chord > 0.0) {
        // Between the centers of the two triangles, square to the edge.
        const double apart =
            (around_.doubled_area(edges[i].first) + around_.doubled_area(edges[i].second)) /
            (3.0 * lengths[i]);
        curvature_ = std::max(curvature_, chord / apart);
      }
    }
    // Half of the places of edges are on sharp ones, where there are any.
    const std::size_t sharp = is_sharp_ ? kEdgePlaces / 2 : 0;
    edges_ = share_out(edges.size(), sharp, [&](std::size_t i) { return sharp_lengths[i]; });
    for (const std::uint32_t edge :
         share_out(edges.size(), kEdgePlaces - sharp, [&](std::size_t i) { return lengths[i]; })) {
      edges_.push_back(edge);
    }
    const std::size_t vertices = mesh.vertices().size();
    vertices_ =
        share_out(vertices, std::min(vertices, kMostVertices), [](std::size_t) { return 1.0; });
    const std::size_t more = visible_ != nullptr ? kPlacesForHidden : 0;
    faces_ = spread_over_faces(mesh, kLeastPlaces + more - edges_.size() - vertices_.size());
  }

  double push(std::uint32_t triangle) const {
    return std::max(least_push_, std::min(most_push_, kPushedHeight * around_.height(triangle)));
  }

  void add_star(std::uint32_t vertex, std::vector<std::uint32_t>& triangles) const {
    const auto star = around_.star(vertex);
    const std::size_t step = (star.size() + kMostAround - 1) / kMostAround;
    for (std::size_t i = 0; i < star.size(); i += step) triangles.push_back(star[i]);
  }

  void find_place(std::size_t i, Place& place) const {
    place.own.clear();
    place.around.clear();
    if (i < vertices_.size()) return find_vertex(vertices_[i], place);
    i -= vertices_.size();
    if (i < edges_.size()) return find_on_edge(around_.edges()[edges_[i]], i, place);
    i -= edges_.size();
    find_on_face(faces_[i], i, place);
  }

  void find_vertex(std::uint32_t vertex, Place& place) const {
    place.point = around_.mesh().vertices()[vertex];
    place.normal = around_.vertex_normal(vertex);
    add_star(vertex, place.own);
    place.push = most_push_;
    for (const std::uint32_t triangle : place.own) {
      place.push = std::min(place.push, push(triangle));
    }
  }

  void find_on_edge(const MeshEdge& edge, std::size_t i, Place& place) const {
    const Vec3& low = around_.mesh().vertices()[edge.low];
    const Vec3& high = around_.mesh().vertices()[edge.high];
    const double fraction = spread_weights(i)[1];
    place.point = (1.0 - fraction) * low + fraction * high;
    Vec3 normal = around_.normal(edge.first);
    place.own.push_back(edge.first);
    place.push = push(edge.first);
    if (edge.second != kNoTriangle) {
      normal += around_.normal(edge.second);
      place.own.push_back(edge.second);
      place.push = std::min(place.push, push(edge.second));
    }
    place.normal = normalized(normal);
    for (const std::uint32_t vertex : {edge.low, edge.high}) {
      add_if_close(vertex, place);
    }
  }

  void find_on_face(std::uint32_t triangle, std::size_t i, Place& place) const {
    const auto corners = around_.mesh().corners(triangle);
    const std::array<double, 3> weights = spread_weights(i);
    place.point = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    place.normal = around_.normal(triangle);
    place.own.push_back(triangle);
    place.push = push(triangle);
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t across = around_.across(triangle, side);
      if (across != kNoTriangle) place.push = std::min(place.push, push(across));
    }
    for (std::size_t side = 0; side < 3; ++side) {
      const Vec3 along = corners[(side + 1) % 3] - corners[side];
      const double from_side = weights[(side + 2) % 3] * around_.doubled_area(triangle);
      if (from_side > kClose * place.push * length(along)) continue;
      if (const std::uint32_t across = around_.across(triangle, side); across != kNoTriangle) {
        place.around.push_back(across);
      }
    }
    for (const std::uint32_t vertex : around_.mesh().triangles()[triangle]) {
      add_if_close(vertex, place);
    }
  }

  void add_if_close(std::uint32_t vertex, Place& place) const {
    const double squared = squared_length(around_.mesh().vertices()[vertex] - place.point);
    if (squared < 4.0 * kClose * kClose * place.push * place.push) add_star(vertex, place.around);
  }

  /// The surface there does not bound the body: meshes that overlap themselves have such parts.
  bool is_hidden(const Place& place) const {
    if (visible_ == nullptr) return false;
    return !std::ranges::all_of(
        place.own, [&](std::uint32_t triangle) { return is_visible(triangle, place.point); });
  }

  /// Of a place on the triangle.
  bool is_visible(std::uint32_t triangle, const Vec3& p) const {
    if (!pieces_) return true;
    const double rounding = visible_->cutter->rounding();
    const std::vector<VisibleTriangle>& all = visible_->triangles;
    const auto first = std::ranges::lower_bound(all, triangle, {}, &VisibleTriangle::triangle);
    if (first == all.end() || first->triangle != triangle) return false;
    if (first->is_whole) return true;
    // One of thousands of pieces, where an opening leaves it in doubt what is inside.
    bool is_on_piece = false;
    pieces_->visit(widen({p, p}, 2.0 * rounding), [&](std::uint32_t piece) {
      if (is_on_piece || all[piece].triangle != triangle) return;
      const Vec3 closest = closest_point_on_triangle(p, visible_->mesh.corners(piece));
      is_on_piece = squared_length(closest - p) <= rounding * rounding;
    });
    return is_on_piece;
  }

  void measure_field(std::size_t begin, std::size_t end) {
    constexpr std::size_t kEach = std::tuple_size_v<EightFloats>;
    Place place;
    EightPoints eight;
    std::array<std::size_t, kEach> of{};
    std::size_t waiting = 0;
    const auto flush = [&] {
      const EightFloats distances = field_.distances(eight);
      for (std::size_t k = 0; k < waiting; ++k) distances_[of[k]] = std::abs(distances[k]);
      waiting = 0;
    };
    for (std::size_t i = begin; i < end; ++i) {
      find_place(i, place);
      if (place.normal == Vec3{} || is_hidden(place)) continue;
      of[waiting] = i;
      eight.set(waiting++, static_cast<Vec3f>(place.point));
      if (waiting == kEach) flush();
      chords_[i] = static_cast<float>(measure_normal(place));
      points_[i] = {static_cast<Vec3f>(place.point), static_cast<Vec3f>(place.normal)};
    }
    if (waiting > 0) flush();
  }

  /// Puts near places next to one another, without those that were left out.
  void order_places() {
    std::vector<Vec3> points(points_.size());
    std::ranges::transform(points_, points.begin(), [](const ShellElements::Place& place) {
      return static_cast<Vec3>(place.point);
    });
    order_ = order_by_place(points);
    std::erase_if(order_, [&](std::uint32_t i) { return distances_[i] == kLeftOut; });
  }

  /// `added` are the points by which the shell has grown since it was measured last, or null.
  void measure_shell(const PointShell& shell, const BoxFinder* added) {
    const ShellElements elements(list_elements(shell));
    for_tasks(order_.size(), [&](std::size_t begin, std::size_t end) {
      measure_shell(elements, added, begin, end);
    });
  }

  /// Adds the places that are missed by more than the tolerance, the worst first and none next to
  /// another, and returns them.
  std::vector<Bounds> add_points(PointShell& shell) const {
    if (settings_.tolerance == 0.0) return {};
    const auto tolerance = static_cast<float>(settings_.tolerance);
    std::vector<std::uint32_t> missed;
    std::ranges::copy_if(order_, std::back_inserter(missed),
                         [&](std::uint32_t i) { return heights_[i] > tolerance; });
    std::ranges::stable_sort(missed, std::ranges::greater{},
                             [&](std::uint32_t i) { return heights_[i]; });
    std::vector<Vec3f> points;
    std::vector<Vec3f> normals;
    std::vector<float> squared_reaches;
    for (const std::uint32_t i : missed) {
      if (points.size() == kMostAdded) break;
      const auto& [point, normal] = points_[i];
      bool is_new = true;
      for (std::size_t k = 0; k < points.size() && is_new; ++k) {
        is_new = squared_length(point - points[k]) > squared_reaches[k] ||
                 dot(normal, normals[k]) < kSameWay;
      }
      if (!is_new) continue;
      const float reach = kNextTo * gaps_[i];
      points.push_back(point);
      normals.push_back(normal);
      squared_reaches.push_back(reach * reach);
    }
    if (points.empty()) return {};
    shell = shell.with_points(points, normals, settings_.threads);
    std::vector<Bounds> added(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) added[i].extend(static_cast<Vec3>(points[i]));
    return added;
  }

  /// Whether `added` points may change what was measured at places: answers depend on the elements
  /// that are up to twice as far away as the nearest.
  bool may_change(std::span<const std::uint32_t> places, const BoxFinder& added) const {
    constexpr double kReach = 2.0 * (1.0 + 1e-4);  // with the rounding of distances
    Bounds around;
    double farthest = 0.0;
    for (const std::uint32_t i : places) {
      if (heights_[i] == kLeftOut) return true;
      around.extend(static_cast<Vec3>(points_[i].point));
      farthest = std::max(farthest, static_cast<double>(gaps_[i]));
    }
    bool is_near = false;
    added.visit(widen(around, kReach * farthest), [&](std::uint32_t) { is_near = true; });
    return is_near;
  }

  void measure_shell(const ShellElements& elements, const BoxFinder* added, std::size_t begin,
                     std::size_t end) {
    std::array<ShellElements::Place, kGroup> places{};
    std::array<ShellElements::Nearest, kGroup> nearest{};
    float reach = static_cast<float>(least_push_);
    for (std::size_t first = begin; first < end; first += kGroup) {
      const std::size_t count = std::min(kGroup, end - first);
      const auto group = std::span(order_).subspan(first, count);
      if (added != nullptr && !may_change(group, *added)) continue;
      for (std::size_t k = 0; k < count; ++k) places[k] = points_[group[k]];
      elements.find_nearest(std::span(places).first(count), reach, std::span(nearest).first(count));
      for (std::size_t k = 0; k < count; ++k) {
        if (!(nearest[k].distance < std::numeric_limits<float>::infinity())) continue;
        gaps_[group[k]] = nearest[k].distance;
        heights_[group[k]] = nearest[k].height;
      }
    }
  }

  /// Chord between the field's gradient and the cone of the normals of the nearest surface.
  double measure_normal(Place& place) const {
    const Vec3 inside = place.point - place.push * place.normal;
    const Vec3 gradient = static_cast<Vec3>(field_.gradient(static_cast<Vec3f>(inside)));
    const double size = length(gradient);
    constexpr double kVanishing = 1e-6;
    if (!(size > kVanishing)) return kLongestChord;
    const Vec3 direction = gradient / size;

    NormalCone cone;
    const auto add = [&](std::uint32_t triangle) {
      const Vec3& normal = around_.normal(triangle);
      if (normal == Vec3{}) return;
      cone.add(may_be_flipped_ && dot(normal, direction) < 0.0 ? -normal : normal);
    };
    for (const std::uint32_t triangle : place.own) add(triangle);
    if (!place.around.empty()) {
      const double nearest = place.push * (1.0 + kNearestSlack);
      for (const std::uint32_t triangle : place.around) {
        const Vec3 closest = closest_point_on_triangle(inside, around_.mesh().corners(triangle));
        if (squared_length(closest - inside) <= nearest * nearest) add(triangle);
      }
    }
    return cone.chord_to(direction);
  }

  /// Drops the places that were left out.
  static ErrorStatistic summarize(std::vector<float>& values) {
    std::erase(values, kLeftOut);
    if (values.empty()) return {};
    const auto rank = [&](double fraction) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                           fraction * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return static_cast<double>(*at);
    };
    const double median = rank(0.5);
    const double p99 = rank(0.99);
    return {median, p99, static_cast<double>(*std::ranges::max_element(values))};
  }

  /// Pushes; what lies farther from a place is not among the nearest.
  static constexpr double kClose = 2.2;

  Surroundings around_;
  const VisibleSurface* visible_;
  std::optional<BoxFinder> pieces_;  ///< of what is visible
  const GridField& field_;
  const AccuracySettings& settings_;
  double least_push_ = 0.0;
  double most_push_ = 0.0;
  bool may_be_flipped_ = false;
  bool is_sharp_ = false;
  double curvature_ = 0.0;

  std::vector<std::uint32_t> vertices_;  ///< of places
  std::vector<std::uint32_t> edges_;
  std::vector<std::uint32_t> faces_;
  std::vector<ShellElements::Place> points_;  ///< of all places
  std::vector<std::uint32_t> order_;          ///< of places, near ones together
  std::vector<float> distances_;
  std::vector<float> chords_;
  std::vector<float> heights_;
  std::vector<float> gaps_;
};

}  // namespace

Accuracy measure_accuracy(const TriangleMesh& mesh, const GridField& field, PointShell& shell,
                          const AccuracySettings& settings, const VisibleSurface* visible) {
  return Measurement(mesh, visible, field, settings).run(shell);
}

}  // namespace voxshell
