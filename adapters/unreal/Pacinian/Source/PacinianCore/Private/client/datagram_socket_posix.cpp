#ifndef _WIN32

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "datagram_socket.h"

namespace pacinian::client {

namespace {

bool write_path(const std::string& path, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.data(), path.size());
  return true;
}

/// Gives the socket a path, so that it can receive an answer. file: that path.
bool bind_beside(int socket, const std::string& path, const std::string& name, std::string& file) {
  const std::string at = path + "-" + name;
  sockaddr_un own;
  if (!write_path(at, own) || ::bind(socket, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) return false;
  file = at;
  return true;
}

bool connect_datagrams(int socket, const std::string& address, const std::string& name, std::string& file) {
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
  if (address.rfind("unix:", 0) == 0) {
    const std::string path = address.substr(5);
    sockaddr_un to;
    return bind_beside(socket, path, name, file) && write_path(path, to) &&
           ::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
  }
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::strtoul(address.c_str() + 4, nullptr, 10)));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return ::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
}

}  // namespace

DatagramSocket::DatagramSocket(const std::string& address, const std::string& name) {
  const bool is_unix = address.rfind("unix:", 0) == 0;
  if (!is_unix && address.rfind("udp:", 0) != 0) return;
  socket_ = ::socket(is_unix ? AF_UNIX : AF_INET, SOCK_DGRAM, 0);
  if (socket_ < 0 || connect_datagrams(socket_, address, name, file_)) return;
  zmtp::native::close(socket_);
  socket_ = zmtp::native::no_handle;
}

DatagramSocket::~DatagramSocket() {
  if (is_open()) zmtp::native::close(socket_);
  if (!file_.empty()) ::unlink(file_.c_str());
}

bool DatagramSocket::send(const std::uint8_t* data, std::size_t size) {
#ifdef MSG_NOSIGNAL
  constexpr int flags = MSG_NOSIGNAL;
#else
  constexpr int flags = 0;
#endif
  return ::send(socket_, data, size, flags) == static_cast<ssize_t>(size);
}

std::size_t DatagramSocket::receive(std::uint8_t* into, std::size_t size, double seconds) {
  zmtp::native::Watch watch;
  watch.handle = socket_;
  watch.reads = true;
  zmtp::native::wait(&watch, 1, seconds);
  if (!watch.is_ready) return 0;
  const ssize_t count = ::recv(socket_, into, size, MSG_DONTWAIT);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

}  // namespace pacinian::client

#endif
