#ifdef PACINIAN_LIBZMQ

#include "libzmq_socket.h"

#include <cerrno>
#include <mutex>

namespace pacinian::client {

namespace {

/// libzmq may be built with OpenPGM, which one thread must not start while another ends it.
std::mutex& coming_and_going() {
  static std::mutex lock;
  return lock;
}

}  // namespace

Context::Context() {
  const std::lock_guard<std::mutex> guard(coming_and_going());
  context_ = zmq_ctx_new();
  zmq_ctx_set(context_, ZMQ_BLOCKY, 0);
}

Context::~Context() {
  const std::lock_guard<std::mutex> guard(coming_and_going());
  while (zmq_ctx_term(context_) != 0 && zmq_errno() == EINTR) {
  }
}

void Socket::open(Context& context, int kind) {
  close();
  socket_ = zmq_socket(context.get(), kind);
  set(ZMQ_LINGER, 0);
}

void Socket::close() {
  if (socket_) zmq_close(socket_);
  socket_ = nullptr;
}

bool Socket::set(int option, int value) {
  return zmq_setsockopt(socket_, option, &value, sizeof value) == 0;
}

bool Socket::set(int option, std::string_view value) {
  return zmq_setsockopt(socket_, option, value.data(), value.size()) == 0;
}

bool Socket::send(const std::uint8_t* data, std::size_t size) {
  int sent = -1;
  do sent = zmq_send(socket_, data, size, ZMQ_DONTWAIT);
  while (sent < 0 && zmq_errno() == EINTR);
  return sent >= 0;
}

bool Socket::receive(wire::Bytes& into) {
  Message message;
  int more = 1;
  for (bool first = true; more; first = false) {
    int got = -1;
    do got = zmq_msg_recv(message.get(), socket_, first ? ZMQ_DONTWAIT : 0);
    while (got < 0 && zmq_errno() == EINTR);
    if (got < 0) return false;
    more = zmq_msg_more(message.get());
  }
  into.assign(message.data(), message.data() + message.size());
  return true;
}

}  // namespace pacinian::client

#endif
