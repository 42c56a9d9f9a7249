#include "edge_crossings.h"

#include <variant>

#include "contact_list.h"
#include "edge_piece.h"

namespace voxshell::bullet {
namespace {

/// Whether what touches there is not the edge but one of its two faces, beside it: the contact's
/// normal is none of the edge's.
bool is_of_face(const Contact& contact, const EdgePiece& edge, double reach) {
  const Vec3 toward = -1.0 * static_cast<Vec3>(contact.normal);
  const auto outside = static_cast<Vec3f>(edge.place + kOutsideOfReach * reach * toward);
  const Vec3 own = normalized(static_cast<Vec3>(edge.own->gradient(outside)));
  return length(cross(own, toward)) > kLeaningSine;
}

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
                 const Pose& field_from_shell, double reach) {
  const PointShell& shell = *own.participant().shell;
  if (!(reach > 0.0) || shell.edges() == nullptr) return;
  const bool has_faces = other.model() != nullptr;
  std::visit(
      [&](const auto& field) {
        keep_if(contacts, [&](Contact& contact) {
          if (shell.is_point(contact.id) || contact.id >= shell.element_count()) return true;
          const auto place = static_cast<Vec3>(contact.point);
          const EdgePiece edge =
              edge_piece_of(own, contact.id, place, field_from_shell, kLeaningSine);
          const Crossing crossing =
              find_crossing(edge, field, field_from_shell.transform_point(place), reach);
          if (crossing.along != 0.0) {
            move_to(crossing, edge, field, field_from_shell, contact);
            return true;
          }
          return !has_faces || static_cast<double>(contact.depth) > reach ||
                 !is_of_face(contact, edge, reach);
        });
      },
      *other.participant().field);
}

}  // namespace voxshell::bullet
