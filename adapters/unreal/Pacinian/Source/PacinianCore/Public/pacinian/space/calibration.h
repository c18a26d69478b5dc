#pragma once

#include <string>
#include <vector>

#include "pacinian/api.h"
#include "pacinian/space/rigid.h"

namespace pacinian {

/// The pose of the array in the tracked world, from known points that were touched.
struct Calibration {
  Rigid origin;           ///< from the array's frame to the tracked world [m]
  double residual = 0.0;  ///< root mean square distance between known and touched points [m]
  double worst = 0.0;     ///< largest of these distances [m]
};

/// Fits the rigid transform, never a reflection, that moves the `known` points (array's frame) closest to the `touched`
/// ones (tracked world), in the same order [m]. Returns false and the `problem` if there are fewer than three points,
/// or if they do not determine the rotation. Horn, J. Opt. Soc. Am. A 4, 629 (1987).
PACINIANCORE_API bool calibrate(const std::vector<Vec3>& known, const std::vector<Vec3>& touched,
                                Calibration& out, std::string& problem);

}  // namespace pacinian
