#pragma once

#include "zmtp/native_socket.h"

namespace pacinian::client {

/// Ends the wait of a thread. `set` may be called from any thread.
class WakeEvent {
 public:
  WakeEvent();
  ~WakeEvent();
  WakeEvent(const WakeEvent&) = delete;
  WakeEvent& operator=(const WakeEvent&) = delete;

  void set();

  /// Resets the event.
  void clear();

  /// Waits until the event is set, or for this time [s] at most.
  void wait(double seconds) const;

  /// Returns a handle that is readable while the event is set.
  zmtp::native::Handle handle() const { return inside_; }

 private:
  zmtp::native::Handle inside_ = zmtp::native::no_handle, outside_ = zmtp::native::no_handle;
};

}  // namespace pacinian::client
