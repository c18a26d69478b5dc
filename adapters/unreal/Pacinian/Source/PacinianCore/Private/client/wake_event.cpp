#include "wake_event.h"

namespace pacinian::client {

void WakeEvent::wait(double seconds) const {
  zmtp::native::Watch watch = {inside_, true, false, false};
  zmtp::native::wait(&watch, 1, seconds);
}

}  // namespace pacinian::client
