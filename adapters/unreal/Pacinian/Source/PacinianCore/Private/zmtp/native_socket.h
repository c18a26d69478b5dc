#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "endpoint.h"

/// The system's TCP, with non-blocking sockets; see native_socket_posix.cpp and native_socket_windows.cpp.
namespace pacinian::zmtp::native {

#ifdef _WIN32
using Handle = std::uintptr_t;  // SOCKET
#else
using Handle = int;
#endif
constexpr Handle no_handle = static_cast<Handle>(-1);

/// Parses an IP address. Returns false if the text is anything else.
bool read_address(const std::string& text, bool is_v6, std::array<std::uint8_t, 16>& address);

/// Starts to connect. Returns `no_handle` on failure.
Handle connect(const Endpoint& to);

/// Returns whether a socket whose attempt to connect has finished is connected.
bool is_connected(Handle socket);

void close(Handle socket);

/// The number of bytes read or sent. 0: none at present. Nothing: the connection has ended.
using Moved = std::optional<std::size_t>;

Moved receive(Handle socket, std::uint8_t* into, std::size_t size);
Moved send(Handle socket, const std::uint8_t* data, std::size_t size);

/// The events of a socket to wait for. is_ready: whether one occurred.
struct Watch {
  Handle handle = no_handle;  ///< `no_handle`: no socket
  bool reads = false, writes = false;
  bool is_ready = false;
};

/// Waits until one of the sockets is ready, or for this time [s] at most.
void wait(Watch* watches, std::size_t watch_count, double seconds);

}  // namespace pacinian::zmtp::native
