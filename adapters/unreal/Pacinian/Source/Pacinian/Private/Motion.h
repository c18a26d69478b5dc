#pragma once

#include <array>

#include "CoreIncludes.h"

namespace Haptic {

/** Returns whether two poses differ by more than 1 um or 1e-5 rad. */
bool Moved(const pacinian::Rigid& From, const pacinian::Rigid& To);

/** Returns the velocities of a movement between two poses within a time [s]; zero if it is a jump. */
pacinian::wire::Motion MotionOf(const pacinian::Rigid& From, const pacinian::Rigid& To, double Elapsed);

/** Converts a position to the wire's. Clamps it to 10 m along each axis, where nothing is felt. */
std::array<double, 3> ToWire(const pacinian::Vec3& Given);

/** Converts a pose to the wire's, and clamps its position. */
pacinian::wire::Pose ToWire(const pacinian::Rigid& Given);

/** Sets the pose of an object. Returns the fields that all objects have. */
pacinian::wire::HapticObject& Placed(pacinian::wire::Object& Object, const pacinian::wire::Pose& Pose);

}  // namespace Haptic
