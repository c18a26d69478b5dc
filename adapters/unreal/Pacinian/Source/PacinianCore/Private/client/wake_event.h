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

  /// Forgets that it was set.
  void clear();

  /// Waits until it is set, or so long [s].
  void wait(double seconds) const;

  /// What has something to read while it is set.
  zmtp::native::Handle handle() const { return inside_; }

 private:
  zmtp::native::Handle inside_ = zmtp::native::no_handle, outside_ = zmtp::native::no_handle;
};

}  // namespace pacinian::client
