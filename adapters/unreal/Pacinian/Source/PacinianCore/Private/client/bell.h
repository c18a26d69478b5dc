#pragma once

#include "zmtp/native_socket.h"

namespace pacinian::client {

/// Ends the wait of a thread. `ring` may be called from any thread.
class Bell {
 public:
  Bell();
  ~Bell();
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  void ring();

  /// Forgets that it was rung.
  void clear();

  /// Waits until it rings, or so long [s].
  void wait(double seconds) const;

  /// What has something to read while it rings.
  zmtp::native::Handle handle() const { return inside_; }

 private:
  zmtp::native::Handle inside_ = zmtp::native::no_handle, outside_ = zmtp::native::no_handle;
};

}  // namespace pacinian::client
