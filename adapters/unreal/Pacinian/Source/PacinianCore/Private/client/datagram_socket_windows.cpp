#ifdef _WIN32

#include <cstdlib>

#include "datagram_socket.h"
#include "zmtp/windows_headers.h"

namespace pacinian::client {

/// The server's address on Windows is always `udp:` and a port.
DatagramSocket::DatagramSocket(const std::string& address, const std::string&) {
  WSADATA data = {};
  if (address.rfind("udp:", 0) != 0 || ::WSAStartup(MAKEWORD(2, 2), &data) != 0) return;
  const SOCKET made = ::socket(AF_INET, SOCK_DGRAM, IPPROTO_UDP);
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = ::htons(static_cast<u_short>(std::strtoul(address.c_str() + 4, nullptr, 10)));
  to.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
  if (made != INVALID_SOCKET && ::connect(made, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    socket_ = made;
    return;
  }
  if (made != INVALID_SOCKET) ::closesocket(made);
  ::WSACleanup();
}

DatagramSocket::~DatagramSocket() {
  if (!is_open()) return;
  ::closesocket(socket_);
  ::WSACleanup();
}

bool DatagramSocket::send(const std::uint8_t* data, std::size_t size) {
  return ::send(socket_, reinterpret_cast<const char*>(data), static_cast<int>(size), 0) == static_cast<int>(size);
}

std::size_t DatagramSocket::receive(std::uint8_t* into, std::size_t size, double seconds) {
  const DWORD limit = static_cast<DWORD>(seconds * 1e3) + 1;  // [ms]
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, reinterpret_cast<const char*>(&limit), sizeof limit);
  const int count = ::recv(socket_, reinterpret_cast<char*>(into), static_cast<int>(size), 0);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace pacinian::client

#endif
