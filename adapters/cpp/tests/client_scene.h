#pragma once

#include <array>
#include <vector>

#include "../example/hand.h"
#include "pacinian/client.h"
#include "pacinian/wire/bulk.h"

namespace scene {

namespace wire = pacinian::wire;

using example::place_hand;

inline wire::Point point(double x, double y, double z, double pressure) {
  wire::Point made;
  made.position = {x, y, z};
  made.radiation_pressure = pressure;
  return made;
}

/// pressure: 0 for none.
inline wire::Volume ball(double radius, double pressure) {
  wire::Volume made;
  made.shape = wire::Sphere{radius};
  if (pressure != 0.0) made.radiation_pressure = pressure;
  return made;
}

inline wire::Pose pose(double x, double y, double z) {
  wire::Pose made;
  made.position = {x, y, z};
  return made;
}

/// Returns one object with many points.
inline wire::Particles rain(int count) {
  wire::Particles made;
  made.radiation_pressure = 5.0;
  for (int i = 0; i < count; ++i)
    for (const float value : {0.0F, 0.0F, 1e-5F * static_cast<float>(i)})
      wire::append(made.positions, value);
  return made;
}

inline std::array<float, 3> floats(const double* values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])};
}

}  // namespace scene
