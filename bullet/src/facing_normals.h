#pragma once

#include <span>
#include <vector>

#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Gives contacts near edges of the field the normal and depth of the side that the shell's element
/// faces. There, the field's own normal and depth are of whichever side is nearer, if by rounding
/// alone: of bodies that lie flush, places along the rim would be pushed aside and carry nothing.
///
/// Such places are looked up `reach` meters inside the shell's body, or up to eight times as far,
/// where the field is met from outside. Contacts that are outside by more than a tenth of `reach`,
/// or deeper than eight of it, stay as they are, and so do those whose normal already opposes the
/// element's. `thickness` is that of Bullet's margins about the field, meters. With a reach of 0,
/// all stay: so they should in fields that round edges off. So do those of uniform shells, which
/// have no edges among their elements.
void face_elements(std::span<Contact> contacts, const Field& field, const PointShell& shell,
                   const Pose& field_from_shell, double reach, double thickness);

/// What drop_from_behind() found.
struct Opposition {
  float buried = 0.0f;      ///< depth of the deepest contact that was dropped, meters
  bool is_opposed = false;  ///< some contact pushes against its element
};

/// Drops contacts that would push their element out of the field along its own outward normal: what
/// lies behind the element would follow it through the same place, and the bodies would overlap no
/// less. Two balls of which each holds the other's middle would pull each other together. Drops
/// contacts deeper than `deep` that push aside as well. Contacts farther from the field than
/// `reach` stay: their bodies may turn before they touch. Meters. Decision 38.
void drop_from_behind(std::vector<Contact>& contacts, const PointShell& shell, float reach,
                      float deep, Opposition& opposition);

}  // namespace voxshell::bullet
