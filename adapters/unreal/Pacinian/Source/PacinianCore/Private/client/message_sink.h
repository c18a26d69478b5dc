#pragma once

#include <cstdint>
#include <vector>

#include "pacinian/client/events.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/writer.h"

namespace pacinian::client {

/// Sends messages to the sockets. The methods return false if there is no room.
class MessageSink {
 public:
  virtual bool send_control(const wire::Writer& message) = 0;
  virtual bool send_command(const wire::Writer& message) = 0;

 protected:
  ~MessageSink() = default;
};

/// When a command was written, and its time to live [s]. waits: whether it is still to be sent.
struct Stamp {
  double time = 0.0, ttl = 0.0;
  bool waits = false;
};

/// Sends the commands of one session.
struct CommandSender {
  MessageSink& outlet;
  const wire::Bytes& session;
  std::int64_t& sequence;
  wire::Writer& writer;

  /// Sends a command. Returns false if there is no room.
  template <class Command>
  bool send(Command& command, const Stamp& stamp) {
    command.session = session;
    command.sequence = ++sequence;
    command.time = stamp.time;
    command.ttl = stamp.ttl;
    writer.clear();
    writer.put(command);
    return outlet.send_command(writer);
  }
};

}  // namespace pacinian::client
