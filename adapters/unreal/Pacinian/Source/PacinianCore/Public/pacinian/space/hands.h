#pragma once

#include <array>

#include "pacinian/api.h"
#include "pacinian/space/rigid.h"
#include "pacinian/wire/commands.h"

namespace pacinian {

/// A hand: joints in OpenXR's order (palm, wrist, thumb from its metacarpal on, index...), and the distance of each to
/// the skin.
struct Hand {
  std::array<Vec3, 26> joints;
  std::array<double, 26> radii{};
};

/// Returns an adult's open hand [m]. palm: its pose; without rotation, the palm faces down, and the fingers point along
/// y.
PACINIANCORE_API Hand open_hand(wire::HandFrameSide side, const Rigid& palm);

/// A bone of Ultraleap's LEAP_HAND, in any unit of length. width: of the flesh around it.
struct LeapBone {
  Vec3 prev_joint, next_joint;
  double width = 0.0;
};

constexpr double adult_wrist_radius = 0.021;  ///< [m]

/// Converts a hand of Ultraleap's LeapC, in the unit of its bones. digits: from the thumb on, each with its metacarpal,
/// proximal, intermediate and distal bone; the thumb's metacarpal is not used, because it has no length. wrist: the
/// arm's next_joint; wrist_radius: in the same unit, because LeapC does not report it. The palm is the middle of the
/// middle finger's metacarpal, as in OpenXR.
PACINIANCORE_API Hand leap_hand(const std::array<std::array<LeapBone, 4>, 5>& digits, Vec3 wrist,
                                double wrist_radius = adult_wrist_radius);

/// Converts a hand in the array's frame [m] to the wire's.
PACINIANCORE_API wire::HandFrame to_frame(const Hand& hand, wire::HandFrameSide side);

}  // namespace pacinian
