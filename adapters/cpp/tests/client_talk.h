#pragma once

#include "client/server_session.h"
#include "client_check.h"

namespace talk {

namespace wire = pacinian::wire;
using pacinian::client::ServerSession;

inline wire::Hello hello() {
  wire::Hello made;
  made.protocol = {1, 0};
  made.client = "test";
  return made;
}

/// A session, with a server whose answers the test sets.
struct Talk : ServerSession {
  Talk() : ServerSession(hello(), 2.0) {}

  template <class T>
  void reply(T message) {
    wire::Writer writer;
    wire::encode(wire::AnyReply(std::move(message)), writer, SIZE_MAX);
    handle_message(writer.data(), writer.size(), now);
  }
  void send() { ServerSession::send_requests(now, sink); }
  template <class T>
  std::vector<T> sent() const {
    return check::Sink::of<T>(sink.controls);
  }
  wire::Welcome welcoming(std::int64_t major = 1) {
    wire::Welcome made;
    made.id = sent<wire::Hello>().back().id;
    made.session.assign(16, ++key);
    made.protocol = {major, 3};
    made.scene = "own";
    made.lease = 0.25;
    return made;
  }
  void connect() {
    begin(now);
    send();
    reply(welcoming());
    send();
    wire::Abilities found;
    found.id = sent<wire::Capabilities>().back().id;
    reply(found);
  }
  void fail(std::int64_t id, wire::Code code, const char* message = "why") {
    wire::Error error;
    error.id = id;
    error.code = code;
    error.message = message;
    reply(error);
  }
  void ok(std::int64_t id) {
    wire::Ok done;
    done.id = id;
    reply(done);
  }
  std::size_t renewals(double until) {
    const std::size_t before = sent<wire::Renew>().size();
    for (; now < until; now += 0.001) send();
    return sent<wire::Renew>().size() - before;
  }

  check::Sink sink;
  double now = 100.0;
  std::uint8_t key = 0;
};

}  // namespace talk
