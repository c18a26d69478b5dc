#pragma once

#include <array>

#include "pacinian/api.h"
#include "pacinian/space/rigid.h"
#include "pacinian/wire/commands.h"

namespace pacinian {

/// A hand: joints in OpenXR's order (palm, wrist, thumb from the wrist on, index...), and from each to the skin.
struct Hand {
  std::array<Vec3, 26> joints;
  std::array<double, 26> radii{};
};

/// An adult's open hand [m]. palm: its pose; a palm without rotation faces down, its fingers along y.
PACINIANCORE_API Hand open_hand(wire::HandFrameSide side, const Rigid& palm);

/// A bone of Ultraleap's LEAP_HAND, in any unit of length. width: of the flesh around it.
struct LeapBone {
  Vec3 prev_joint, next_joint;
  double width = 0.0;
};

/// A hand as Ultraleap's LeapC tells it, in the unit of its bones. digits: from the thumb on, of each the metacarpal,
/// proximal, intermediate and distal bone; the thumb's metacarpal is not used, as it has no length. wrist: the arm's
/// next_joint, and its radius in that unit, which LeapC does not tell. The palm is the middle of the middle finger's
/// metacarpal, as in OpenXR.
PACINIANCORE_API Hand leap_hand(const std::array<std::array<LeapBone, 4>, 5>& digits, Vec3 wrist,
                                double wrist_radius = 0.021);

/// What is sent of a hand, whose lengths are in the array's frame [m].
PACINIANCORE_API wire::HandFrame to_frame(const Hand& hand, wire::HandFrameSide side);

}  // namespace pacinian
