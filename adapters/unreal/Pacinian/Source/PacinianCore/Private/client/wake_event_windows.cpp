#ifdef _WIN32

#include "wake_event.h"
#include "zmtp/windows_headers.h"

namespace pacinian::client {

namespace {

/// Opens a local UDP socket that is connected to itself and receives from no other; `no_handle` on failure.
zmtp::native::Handle open_echo() {
  const SOCKET made = ::socket(AF_INET, SOCK_DGRAM, IPPROTO_UDP);
  if (made == INVALID_SOCKET) return zmtp::native::no_handle;
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
  auto* const at = reinterpret_cast<sockaddr*>(&address);
  int size = sizeof address;
  u_long is_nonblocking = 1;
  if (::bind(made, at, size) == 0 && ::getsockname(made, at, &size) == 0 && ::connect(made, at, size) == 0 &&
      ::ioctlsocket(made, FIONBIO, &is_nonblocking) == 0)
    return made;
  ::closesocket(made);
  return zmtp::native::no_handle;
}

}  // namespace

/// Uses a socket, because Winsock's select waits only for sockets. If there is none, waits end when their time is over.
WakeEvent::WakeEvent() {
  WSADATA winsock;
  if (::WSAStartup(MAKEWORD(2, 2), &winsock) != 0) return;
  inside_ = outside_ = open_echo();
  if (inside_ == zmtp::native::no_handle) ::WSACleanup();
}

WakeEvent::~WakeEvent() {
  if (inside_ == zmtp::native::no_handle) return;
  ::closesocket(inside_);
  ::WSACleanup();
}

void WakeEvent::set() { ::send(outside_, "", 1, 0); }

void WakeEvent::clear() {
  char ring;
  while (::recv(inside_, &ring, 1, 0) == 1) {
  }
}

}  // namespace pacinian::client

#endif
