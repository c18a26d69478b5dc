#pragma once

#include <vector>

#include "client/message_sink.h"
#include "expect.h"
#include "server_side/decode.h"

namespace check {

/// Stores what is sent, as long as there is room.
class Sink : public pacinian::client::MessageSink {
 public:
  bool send_control(const pacinian::wire::Writer& message) override {
    return keep(message, controls, pacinian::wire::decode_control);
  }
  bool send_command(const pacinian::wire::Writer& message) override {
    return keep(message, commands, pacinian::wire::decode_command);
  }

  /// Returns the messages of one type.
  template <class T, class Any>
  static std::vector<T> of(const std::vector<Any>& all) {
    std::vector<T> found;
    for (const Any& any : all)
      if (const T* message = std::get_if<T>(&any)) found.push_back(*message);
    return found;
  }

  std::vector<pacinian::wire::AnyControl> controls;
  std::vector<pacinian::wire::AnyCommand> commands;
  bool full = false;

 private:
  template <class Any, class Decode>
  bool keep(const pacinian::wire::Writer& message, std::vector<Any>& to, Decode decode) {
    if (full) return false;
    pacinian::wire::WireError wrong;
    to.emplace_back();
    expect(decode(message.data(), message.size(), to.back(), wrong), wrong.problem.c_str(), __LINE__);
    return true;
  }
};

}  // namespace check
