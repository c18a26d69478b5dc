#pragma once

#include <string>
#include <vector>

#include "pacinian/api.h"
#include "pacinian/space/rigid.h"

namespace pacinian {

/// Where the array stands in the tracked world, from known points of it that were touched.
struct Calibration {
  Rigid origin;           ///< from the array's frame to the tracked world [m]
  double residual = 0.0;  ///< root mean square distance of known from touched points [m]
  double worst = 0.0;     ///< largest of these distances [m]
};

/// The rigid transform, never a reflection, that brings `known` points (array's frame) closest to those `touched`
/// (tracked world), in the same order [m]. False, with the `problem`, if there are fewer than 3 or they do not say how
/// it is turned. Horn, J. Opt. Soc. Am. A 4, 629 (1987).
PACINIANCORE_API bool calibrate(const std::vector<Vec3>& known, const std::vector<Vec3>& touched,
                                Calibration& out, std::string& problem);

}  // namespace pacinian
