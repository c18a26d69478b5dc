#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "wake_event.h"
#include "connection_file.h"
#include "connection_failure.h"
#include "pacinian/wire/types.h"

namespace pacinian::client {

/// A connection's first end, and where that was.
struct End {
  Ending how = Ending::none;
  Channel where = Channel::control;
};

/// Carries whole messages to and from one server. It belongs to one thread, and nothing but `wait` waits. Once `control`
/// or `command` has ended it does not come back by itself, and it takes a message only while it stands: so nothing old
/// can reach a server that was started anew. When it is destroyed, what was not sent is not sent any more.
class Transport {
 public:
  virtual ~Transport() = default;

  /// False if there is no room. The next wait ends when there is.
  virtual bool send(Channel channel, const std::uint8_t* data, std::size_t size) = 0;

  /// The last part of the next message; false if there is none.
  virtual bool receive(Channel channel, wire::Bytes& into) = 0;

  virtual End ended() = 0;

  /// Waits until something has come, the wake event is set, or so long [s].
  virtual void wait(double seconds, const WakeEvent* wake) = 0;
};

/// Begins to connect, to all channels or to `control` alone: with a token by the system's sockets, with CURVE keys by
/// libzmq. Null, with the reason, if it cannot.
std::unique_ptr<Transport> connect(const ConnectionFile& connection, bool to_all, ConnectionFailure& loss);

}  // namespace pacinian::client
