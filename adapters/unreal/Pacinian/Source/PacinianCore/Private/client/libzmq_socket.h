#pragma once

#include <zmq.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pacinian/wire/types.h"

namespace pacinian::client {

/// A ZeroMQ context. Close all its sockets before it.
class Context {
 public:
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  void* get() const { return context_; }

 private:
  void* context_;
};

/// A received message, in the library's memory.
class Message {
 public:
  Message() { zmq_msg_init(&message_); }
  ~Message() { zmq_msg_close(&message_); }
  Message(const Message&) = delete;
  Message& operator=(const Message&) = delete;
  zmq_msg_t* get() { return &message_; }
  const std::uint8_t* data() { return static_cast<const std::uint8_t*>(zmq_msg_data(&message_)); }
  std::size_t size() const { return zmq_msg_size(&message_); }

 private:
  zmq_msg_t message_;
};

/// A ZeroMQ socket. Closing it drops messages that were not sent. Belongs to one thread.
class Socket {
 public:
  Socket() = default;
  ~Socket() { close(); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void open(Context& context, int kind);
  void close();
  void* get() const { return socket_; }
  bool set(int option, int value);
  bool set(int option, std::string_view value);
  bool connect(const std::string& at) { return zmq_connect(socket_, at.c_str()) == 0; }

  /// Sends a message. Returns false if there is no room.
  bool send(const std::uint8_t* data, std::size_t size);

  /// Receives the last part of the next message. Returns false if there is none.
  bool receive(wire::Bytes& into);

 private:
  void* socket_ = nullptr;
};

}  // namespace pacinian::client
