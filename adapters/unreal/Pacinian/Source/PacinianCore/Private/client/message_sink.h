#pragma once

#include <cstdint>
#include <vector>

#include "pacinian/client/events.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/writer.h"

namespace pacinian::client {

/// Where messages go. Each is false if there is no room.
class MessageSink {
 public:
  virtual bool control(const wire::Writer& message) = 0;
  virtual bool command(const wire::Writer& message) = 0;

 protected:
  ~MessageSink() = default;
};

/// When something was asked for, and for how long it is wanted [s]. waits: it has not been sent yet.
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

  /// False if there is no room.
  template <class Command>
  bool send(Command& command, const Stamp& stamp) {
    command.session = session;
    command.sequence = ++sequence;
    command.time = stamp.time;
    command.ttl = stamp.ttl;
    writer.clear();
    writer.put(command);
    return outlet.command(writer);
  }
};

}  // namespace pacinian::client
