#include "edge_crossings.h"

#include <variant>

#include "edge_piece.h"

namespace voxshell::bullet {
namespace {

template <class F>
void move_to(const Crossing& crossing, const EdgePiece& edge, const F& field,
             const Pose& field_from_shell, Contact& contact) {
  contact.point = static_cast<Vec3f>(edge.place + crossing.along * edge.along);
  const Vec3 place = field_from_shell.transform_point(static_cast<Vec3>(contact.point));
  const auto distance = static_cast<double>(field.distance(static_cast<Vec3f>(place)));
  contact.depth = static_cast<float>(-distance / length(crossing.outwards));
  contact.normal =
      static_cast<Vec3f>(field_from_shell.inverse().rotate(normalized(crossing.outwards)));
}

}  // namespace

void cross_edges(std::vector<Contact>& contacts, const Side& own, const Side& other,
                 const Pose& field_from_shell, double way) {
  const PointShell& shell = *own.participant().shell;
  if (shell.edges() == nullptr) return;
  std::visit(
      [&](const auto& field) {
        for (Contact& contact : contacts) {
          if (shell.is_point(contact.id) || contact.id >= shell.element_count()) continue;
          const auto place = static_cast<Vec3>(contact.point);
          const EdgePiece edge =
              edge_piece_of(own, contact.id, place, Pose{}, field_from_shell, kLeaningSine);
          const Crossing crossing =
              find_crossing(edge, field, field_from_shell.transform_point(place), way);
          if (crossing.along != 0.0) move_to(crossing, edge, field, field_from_shell, contact);
        }
      },
      *other.participant().field);
}

}  // namespace voxshell::bullet
