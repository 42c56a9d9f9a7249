#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include "voxshell/bullet/contact_settings.h"

namespace voxshell::bullet {

/// Whether the bounds of two objects, one of them a model, tell that they do not touch within the
/// step, nor come to rest on each other. The broad phase knows boxes along the world's axes that
/// are larger than the bodies by centimeters, so this is what most of its pairs are.
bool are_apart(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
               const ContactSettings& settings, double time_step);

}  // namespace voxshell::bullet
