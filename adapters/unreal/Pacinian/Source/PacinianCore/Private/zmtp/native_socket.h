#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "endpoint.h"

/// TCP as the system has it, with sockets that never wait: in native_socket_posix.cpp and native_socket_windows.cpp.
namespace pacinian::zmtp::native {

#ifdef _WIN32
using Handle = std::uintptr_t;  // SOCKET
#else
using Handle = int;
#endif
constexpr Handle no_handle = static_cast<Handle>(-1);

/// Reads an IP address; false if it is none.
bool read_address(const std::string& text, bool is_v6, std::array<std::uint8_t, 16>& address);

/// Begins to connect; `no_handle` if that is impossible.
Handle connect(const Endpoint& to);

/// Whether a socket that could be waited for to the end of its connecting is connected.
bool is_connected(Handle socket);

void close(Handle socket);

/// Bytes that were read or sent. 0: none now. Nothing: none ever again.
using Moved = std::optional<std::size_t>;

Moved receive(Handle socket, std::uint8_t* into, std::size_t size);
Moved send(Handle socket, const std::uint8_t* data, std::size_t size);

/// What is waited for of a socket. is_ready: whether it has come.
struct Watch {
  Handle handle = no_handle;  ///< `no_handle`: nothing
  bool reads = false, writes = false;
  bool is_ready = false;
};

/// Waits until one of some sockets is ready, or so long [s].
void wait(Watch* watches, std::size_t count, double seconds);

}  // namespace pacinian::zmtp::native
