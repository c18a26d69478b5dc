#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "pacinian/api.h"
#include "pacinian/wire/state.h"

namespace pacinian {

/// What is felt of an object's surface or volume, against what was asked: between its samples, over the last second or
/// so. All numbers are NaN where the server does not tell: of points and paths, and in silence.
struct RegionFelt {
  static constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

  float force = unknown;  ///< over what was asked; 1 if right
  float rms = unknown;    ///< root mean square of the error of radiation pressure, over that of what was asked
  float holes = unknown;  ///< share of the region that is pressed with less than half of what was asked
  float spill = unknown;  ///< highest radiation pressure 3 to 5 mm beside the region, over the mean asked

  /// Whether the server tells.
  bool known() const { return !std::isnan(force); }

  /// Of the object of that name, in a state; nothing is allocated. state: may be null.
  PACINIANCORE_API static RegionFelt of(const wire::State* state, std::string_view name);
};

}  // namespace pacinian
