#ifdef _WIN32

#include <algorithm>
#include <cmath>
#include <cstring>

#include "native_socket.h"
#include "windows_headers.h"

namespace pacinian::zmtp::native {

namespace {

constexpr double max_seconds = 3600.0;      // of one wait
constexpr std::size_t max_bytes = 1 << 20;  // in one call

/// Initialises Winsock at its first use, until the end of the process.
struct Winsock {
  Winsock() { is_there = ::WSAStartup(MAKEWORD(2, 2), &data) == 0; }
  ~Winsock() {
    if (is_there) ::WSACleanup();
  }
  WSADATA data = {};
  bool is_there = false;
};

bool start_winsock() {
  static const Winsock winsock;
  return winsock.is_there;
}

bool set_up(Handle socket) {
  const BOOL on = TRUE;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, reinterpret_cast<const char*>(&on), sizeof on);
  ::SetHandleInformation(reinterpret_cast<HANDLE>(socket), HANDLE_FLAG_INHERIT, 0);
  u_long is_nonblocking = 1;
  return ::ioctlsocket(socket, FIONBIO, &is_nonblocking) == 0;
}

/// Writes an address in the system's form. Returns its size.
int write(const Endpoint& to, sockaddr_storage& storage) {
  storage = {};
  if (to.is_v6) {
    sockaddr_in6 address = {};
    address.sin6_family = AF_INET6;
    address.sin6_port = ::htons(to.port);
    std::memcpy(&address.sin6_addr, to.address.data(), sizeof address.sin6_addr);
    std::memcpy(&storage, &address, sizeof address);
    return sizeof address;
  }
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = ::htons(to.port);
  std::memcpy(&address.sin_addr, to.address.data(), sizeof address.sin_addr);
  std::memcpy(&storage, &address, sizeof address);
  return sizeof address;
}

Moved count(int moved) {
  if (moved >= 0) return static_cast<std::size_t>(moved);
  const int error = ::WSAGetLastError();
  return error == WSAEWOULDBLOCK || error == WSAEINTR ? Moved(0) : std::nullopt;
}

}  // namespace

bool read_address(const std::string& text, bool is_v6, std::array<std::uint8_t, 16>& address) {
  return start_winsock() && ::inet_pton(is_v6 ? AF_INET6 : AF_INET, text.c_str(), address.data()) == 1;
}

Handle connect(const Endpoint& to) {
  if (!start_winsock()) return no_handle;
  const Handle made = ::socket(to.is_v6 ? AF_INET6 : AF_INET, SOCK_STREAM, IPPROTO_TCP);
  if (made == no_handle) return no_handle;
  sockaddr_storage address;
  const int size = write(to, address);
  const bool begun = set_up(made) && (::connect(made, reinterpret_cast<const sockaddr*>(&address), size) == 0 ||
                                      ::WSAGetLastError() == WSAEWOULDBLOCK);
  if (begun) return made;
  close(made);
  return no_handle;
}

bool is_connected(Handle socket) {
  int error = 0, size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, reinterpret_cast<char*>(&error), &size) == 0 && error == 0;
}

void close(Handle socket) { ::closesocket(socket); }

Moved receive(Handle socket, std::uint8_t* into, std::size_t size) {
  const int got = ::recv(socket, reinterpret_cast<char*>(into), static_cast<int>(std::min(size, max_bytes)), 0);
  return got == 0 ? std::nullopt : count(got);
}

Moved send(Handle socket, const std::uint8_t* data, std::size_t size) {
  return count(::send(socket, reinterpret_cast<const char*>(data), static_cast<int>(std::min(size, max_bytes)), 0));
}

/// Uses select, because WSAPoll before Windows 10 2004 does not report failed connections. A set holds 64 sockets,
/// whatever their numbers.
void wait(Watch* watches, std::size_t watch_count, double seconds) {
  fd_set reads, writes, fails;
  FD_ZERO(&reads);
  FD_ZERO(&writes);
  FD_ZERO(&fails);
  bool has_some = false;
  for (std::size_t i = 0; i < watch_count; ++i) {
    if (watches[i].handle == no_handle) continue;
    if (watches[i].reads) FD_SET(watches[i].handle, &reads);
    if (watches[i].writes) FD_SET(watches[i].handle, &writes);
    FD_SET(watches[i].handle, &fails);
    has_some = true;
  }
  const double milliseconds = std::ceil(1e3 * std::max(0.0, std::min(seconds, max_seconds)));
  const long whole = static_cast<long>(milliseconds);
  timeval limit = {whole / 1000, whole % 1000 * 1000};
  if (!has_some) return ::Sleep(static_cast<DWORD>(whole));  // select rejects empty sets
  const int ready = ::select(0, &reads, &writes, &fails, &limit);
  for (std::size_t i = 0; i < watch_count; ++i) {
    const Handle handle = watches[i].handle;
    watches[i].is_ready = ready > 0 && handle != no_handle &&
                          (FD_ISSET(handle, &reads) || FD_ISSET(handle, &writes) || FD_ISSET(handle, &fails));
  }
}

}  // namespace pacinian::zmtp::native

#endif
