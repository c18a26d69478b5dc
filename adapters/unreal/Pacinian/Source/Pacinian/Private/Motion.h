#pragma once

#include "Core.h"

namespace Haptic {

/** Whether a pose is another by more than 1 um or 1e-5 rad. */
bool Moved(const pacinian::Rigid& From, const pacinian::Rigid& To);

/** How something moved from one pose to the other in so long [s]; not at all, if it jumped. */
pacinian::wire::Motion MotionOf(const pacinian::Rigid& From, const pacinian::Rigid& To, double Elapsed);

/** As the server is told; what is beyond 10 m counts as there, where nothing is felt either. */
pacinian::wire::Pose ToWire(const pacinian::Rigid& Given);

/** Puts an object somewhere. What all objects have. */
pacinian::wire::Felt& Placed(pacinian::wire::Object& Object, const pacinian::wire::Pose& Pose);

}  // namespace Haptic
