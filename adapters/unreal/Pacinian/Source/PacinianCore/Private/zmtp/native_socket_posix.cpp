#ifndef _WIN32

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "native_socket.h"

namespace pacinian::zmtp::native {

namespace {

constexpr std::size_t max_watches = 8;
constexpr double max_seconds = 3600.0;  // of one wait

#ifdef MSG_NOSIGNAL
constexpr int no_signal = MSG_NOSIGNAL;  // otherwise a closed connection would end the process
#else
constexpr int no_signal = 0;  // on macOS, SO_NOSIGPIPE does that
#endif

bool set_up(Handle socket) {
  const int on = 1;
#ifdef SO_NOSIGPIPE
  ::setsockopt(socket, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
#endif
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const int flags = ::fcntl(socket, F_GETFL);
  return flags >= 0 && ::fcntl(socket, F_SETFL, flags | O_NONBLOCK) == 0 &&
         ::fcntl(socket, F_SETFD, FD_CLOEXEC) == 0;
}

/// Writes an address in the system's form. Returns its size.
socklen_t write(const Endpoint& to, sockaddr_storage& storage) {
  storage = {};
  if (to.is_v6) {
    sockaddr_in6 address = {};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(to.port);
    std::memcpy(&address.sin6_addr, to.address.data(), sizeof address.sin6_addr);
    std::memcpy(&storage, &address, sizeof address);
    return sizeof address;
  }
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(to.port);
  std::memcpy(&address.sin_addr, to.address.data(), sizeof address.sin_addr);
  std::memcpy(&storage, &address, sizeof address);
  return sizeof address;
}

bool may_go_on(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

Moved count(ssize_t moved) {
  if (moved >= 0) return static_cast<std::size_t>(moved);
  return may_go_on(errno) ? Moved(0) : std::nullopt;
}

}  // namespace

bool read_address(const std::string& text, bool is_v6, std::array<std::uint8_t, 16>& address) {
  return ::inet_pton(is_v6 ? AF_INET6 : AF_INET, text.c_str(), address.data()) == 1;
}

Handle connect(const Endpoint& to) {
  const Handle made = ::socket(to.is_v6 ? AF_INET6 : AF_INET, SOCK_STREAM, 0);
  if (made < 0) return no_handle;
  sockaddr_storage address;
  const socklen_t size = write(to, address);
  const bool begun = set_up(made) && (::connect(made, reinterpret_cast<const sockaddr*>(&address), size) == 0 ||
                                      errno == EINPROGRESS || errno == EINTR);
  if (begun) return made;
  close(made);
  return no_handle;
}

bool is_connected(Handle socket) {
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

void close(Handle socket) { ::close(socket); }

Moved receive(Handle socket, std::uint8_t* into, std::size_t size) {
  const ssize_t got = ::recv(socket, into, size, 0);
  return got == 0 ? std::nullopt : count(got);
}

Moved send(Handle socket, const std::uint8_t* data, std::size_t size) {
  return count(::send(socket, data, size, no_signal));
}

void wait(Watch* watches, std::size_t watch_count, double seconds) {
  pollfd polled[max_watches];
  watch_count = std::min(watch_count, max_watches);
  for (std::size_t i = 0; i < watch_count; ++i)
    polled[i] = {watches[i].handle,
                 static_cast<short>((watches[i].reads ? POLLIN : 0) | (watches[i].writes ? POLLOUT : 0)), 0};
  const double milliseconds = 1e3 * std::max(0.0, std::min(seconds, max_seconds));
  const int ready = ::poll(polled, static_cast<nfds_t>(watch_count), static_cast<int>(std::ceil(milliseconds)));
  for (std::size_t i = 0; i < watch_count; ++i) watches[i].is_ready = ready > 0 && polled[i].revents != 0;
}

}  // namespace pacinian::zmtp::native

#endif
