#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "pacinian/api.h"
#include "pacinian/wire/state.h"

namespace pacinian {

/// The achieved pressure of an object's surface or volume, compared with the requested one, over about the last second:
/// on all touched skin or, in free air, between the samples. All numbers are NaN if the server does not report them: for
/// points and paths, and in silence.
struct RegionFelt {
  static constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

  float force = unknown;  ///< achieved force divided by the requested one; 1 is ideal
  float rms = unknown;    ///< error of the radiation pressure, relative to the requested one
  float holes = unknown;  ///< fraction of the region with less than half of the requested pressure
  /// The highest radiation pressure beside the region (3 to 30 mm on skin, 3 to 5 mm in free air), relative to the mean
  /// requested one.
  float spill = unknown;

  /// Returns whether the server reports the numbers.
  bool known() const { return !std::isnan(force); }

  /// Returns the numbers of the object with this name. Allocates nothing. state: may be null.
  PACINIANCORE_API static RegionFelt of(const wire::State* state, std::string_view name);
};

}  // namespace pacinian
