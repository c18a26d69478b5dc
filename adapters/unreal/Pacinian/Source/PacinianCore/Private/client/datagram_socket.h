#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "zmtp/native_socket.h"

namespace pacinian::client {

/// A datagram socket on this machine that is connected to another and can receive its answers; see
/// datagram_socket_posix.cpp and datagram_socket_windows.cpp.
class DatagramSocket {
 public:
  /// address: `unix:` and the path of a socket, or `udp:` and a port on 127.0.0.1. name: what follows that path, and a
  /// hyphen, in the path of this socket.
  DatagramSocket(const std::string& address, const std::string& name);
  ~DatagramSocket();
  DatagramSocket(const DatagramSocket&) = delete;
  DatagramSocket& operator=(const DatagramSocket&) = delete;

  /// Whether it is connected.
  bool is_open() const { return socket_ != zmtp::native::no_handle; }

  /// Returns false if the other one has gone.
  bool send(const std::uint8_t* data, std::size_t size);

  /// Waits for a datagram for this time [s] at most. Returns its size; 0 if none came.
  std::size_t receive(std::uint8_t* into, std::size_t size, double seconds);

 private:
  zmtp::native::Handle socket_ = zmtp::native::no_handle;
  std::string file_;  // of this socket, if it has one
};

}  // namespace pacinian::client
