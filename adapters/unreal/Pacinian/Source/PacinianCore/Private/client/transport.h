#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "wake_event.h"
#include "connection_file.h"
#include "connection_failure.h"
#include "pacinian/wire/types.h"

namespace pacinian::client {

/// How a connection ended first, and on which socket.
struct End {
  Ending how = Ending::none;
  Channel where = Channel::control;
};

/// Carries whole messages to and from one server. Belongs to one thread, and only `wait` blocks. A connection of
/// `control` or `command` that has ended does not come back, and it accepts messages only while it is connected.
/// Therefore no old message reaches a restarted server. The destructor drops messages that were not sent.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Sends a message. Returns false if there is no room; the next wait then ends when there is.
  virtual bool send(Channel channel, const std::uint8_t* data, std::size_t size) = 0;

  /// Receives the last part of the next message. Returns false if there is none.
  virtual bool receive(Channel channel, wire::Bytes& into) = 0;

  virtual End ended() = 0;

  /// Waits for a message, for the wake event, or for this time [s] at most.
  virtual void wait(double seconds, const WakeEvent* wake) = 0;
};

/// Starts to connect, over the system's sockets if the server uses a token, and over libzmq if it uses CURVE keys.
/// Returns null and the reason on failure. all_sockets: also connect `command` and `state`; otherwise only `control`.
std::unique_ptr<Transport> connect(const ConnectionFile& connection, bool all_sockets, ConnectionFailure& loss);

}  // namespace pacinian::client
