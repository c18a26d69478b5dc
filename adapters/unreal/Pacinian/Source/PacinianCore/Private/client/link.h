#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "connection.h"
#include "loss.h"
#include "socket.h"

namespace pacinian::client {

/// Sets a socket's options, with the connection's token or keys, and connects it to `at`.
bool prepare(Socket& socket, const Connection& connection, const std::string& at, Loss& loss);

/// A DEALER socket to the server and a monitor of its connection: lost once, it is lost for good.
///
/// It does not connect again by itself, and takes a message only while it is connected (IMMEDIATE), so that
/// nothing old can reach a server that was started anew. Heartbeats (ZMTP's) tell of a server that is stopped or cut
/// off. Belongs to one thread.
class Link {
 public:
  /// heartbeat: not where the server may be slow to read, as its heartbeats wait behind what it has not read.
  bool open(Context& context, const Connection& connection, const std::string& at, bool heartbeat,
            Loss& loss);
  void close();

  bool send(const std::uint8_t* data, std::size_t size) { return socket_.send(data, size); }
  bool receive(Message& out) { return socket_.receive(out); }

  /// To be polled.
  void* socket() const { return socket_.get(); }
  void* monitor() const { return monitor_.get(); }

  /// Whether the monitor has told that it is lost, and why. known: whether its server has answered, on this connection
  /// or another: it has gone then.
  bool lost(Loss& loss, bool known);

 private:
  std::string at_;
  Socket socket_, monitor_;
};

}  // namespace pacinian::client
