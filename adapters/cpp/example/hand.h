#pragma once

#include "pacinian/wire/bulk.h"
#include "pacinian/wire/commands.h"

namespace example {

namespace wire = pacinian::wire;

/// Writes an adult's flat right hand in OpenXR's joints. Its palm is at a position [m] and faces down; its fingers
/// point along +y.
inline void place_hand(wire::HandFrame& hand, float x, float y, float z) {
  const auto joint = [&](float right, float forward) {
    for (const float value : {x + right, y + forward, z}) wire::append(hand.joints, value);
  };
  hand.side = wire::HandFrameSide::right;
  hand.joints.clear();
  joint(0.0F, 0.0F);     // palm
  joint(0.0F, -0.055F);  // wrist
  for (const float forward : {-0.03F, 0.0F, 0.03F, 0.055F}) joint(-0.04F - 0.3F * forward, forward);
  const float right[] = {-0.025F, 0.0F, 0.02F, 0.04F}, length[] = {0.09F, 0.1F, 0.09F, 0.07F};
  for (int finger = 0; finger < 4; ++finger)
    for (const float share : {-0.3F, 0.35F, 0.7F, 0.9F, 1.0F})
      joint(right[finger], 0.01F + share * length[finger]);
}

}  // namespace example
