#include <algorithm>
#include <utility>

#include "server_session.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/reader.h"

namespace pacinian::client {

namespace {

constexpr std::size_t most_events = 100;  // waiting for the game

/// Returns the `id` of a message that cannot be decoded; 0 if it has none.
std::int64_t id_of(const std::uint8_t* data, std::size_t size) {
  wire::Reader reader(data, size);
  std::uint32_t left = 0;
  std::int64_t id = 0;
  std::string_view key;
  if (!reader.map(left)) return 0;
  while (left-- > 0 && reader.key(key))
    if (key == "id" ? reader.get(id) : reader.skip()) {
      if (key == "id") return id;
    } else {
      break;
    }
  return 0;
}

Refusal version_refusal(std::int64_t theirs) {
  const std::string problem = "the server speaks protocol " + std::to_string(theirs) +
                              ", this client " + std::to_string(wire::MAJOR);
  return {"version", problem, "", theirs < wire::MAJOR ? "update the server" : "update the client"};
}

template <class... T>
std::int64_t id_of(const std::variant<T...>& reply) {
  std::int64_t id = 0;
  const auto look = [&id](const auto* held) {
    if (held) id = held->id;
  };
  (look(std::get_if<T>(&reply)), ...);
  return id;
}

bool ends_sound(wire::Code code) {
  return code == wire::Code::expired || code == wire::Code::owner || code == wire::Code::fault ||
         code == wire::Code::stopped;
}

Refusal refusal_of(const wire::Error& error) {
  Refusal refusal{std::string(words(error.code)[static_cast<std::size_t>(error.code)]),
                  error.message, error.path, error.advice};
  if (error.code == wire::Code::version && refusal.advice.empty())
    refusal.advice = "update the older of the two: this client speaks " + std::to_string(wire::MAJOR) + "." +
                     std::to_string(wire::MINOR);
  return refusal;
}

}  // namespace

void ServerSession::handle_message(const std::uint8_t* data, std::size_t size, double now) {
  heard_ = now;
  wire::WireError wrong;
  if (wire::decode_reply(data, size, reply_, wrong)) return handle_reply(reply_, now);
  report_unreadable(wrong.problem);
  const std::int64_t id = id_of(data, size);
  const auto asked = std::find_if(asks_.begin(), asks_.end(),
                                  [id](const Ask& ask) { return id != 0 && ask.id == id; });
  if (asked == asks_.end()) return;
  if (asked->kind == Ask::Kind::request || asked->kind == Ask::Kind::field) {
    if (asked->callback) events.push_back({Event::Kind::field, {}, 0, std::move(asked->callback), {}});
    asks_.erase(asked);
  } else {
    set_lost({"the server's answer cannot be read: update the older of game and server", true});
  }
}

void ServerSession::report_unreadable(const std::string& problem) {
  if (std::exchange(unreadable_, true)) return;
  const std::string message = "what the server says cannot be read: " + problem;
  add_event(Event::Kind::refused, {"malformed", message, "", "update the older of game and server"});
}

void ServerSession::add_event(Event::Kind kind, Refusal refusal) {
  if (events.size() >= most_events) events.erase(events.begin());
  events.push_back({kind, std::move(refusal), 0, {}, {}});
}

void ServerSession::handle_reply(wire::AnyReply& reply, double now) {
  if (const auto* renewal = std::get_if<wire::Renewed>(&reply)) return handle_renewal(*renewal, now);
  const std::int64_t id = id_of(reply);
  const auto asked = std::find_if(asks_.begin(), asks_.end(),
                                  [id](const Ask& ask) { return id != 0 && ask.id == id; });
  if (asked == asks_.end()) {
    if (const auto* problem = std::get_if<wire::Error>(&reply)) handle_error(*problem, nullptr);
    return;
  }
  Ask ask = std::move(*asked);
  asks_.erase(asked);
  complete_request(ask, reply, now);
}

void ServerSession::complete_request(Ask& ask, wire::AnyReply& reply, double now) {
  if (phase_ == Phase::leaving) return end();
  if (const auto* problem = std::get_if<wire::Error>(&reply)) return handle_error(*problem, &ask);
  bool good = false;
  if (ask.kind == Ask::Kind::hello) {
    auto* found = std::get_if<wire::Welcome>(&reply);
    if ((good = found != nullptr)) {
      welcome = *found;
      server_clock.add_mark(sent_[0].at, now, welcome.time);
      handle_welcome(now);
    }
  } else if (ask.kind == Ask::Kind::capabilities) {
    auto* found = std::get_if<wire::Abilities>(&reply);
    if ((good = found != nullptr)) {
      abilities = std::make_shared<const wire::Abilities>(std::move(*found));
      phase_ = Phase::connected;
      due_ = now;
      add_event(Event::Kind::connected, {});
    }
  } else if (ask.kind == Ask::Kind::field) {
    auto* found = std::get_if<wire::Pressures>(&reply);
    if ((good = found != nullptr))
      events.push_back({Event::Kind::field, {}, 0, std::move(ask.callback), std::move(found->pressures)});
  } else if ((good = std::holds_alternative<wire::Ok>(reply))) {
    if (ask.of == Request::Kind::arm) armed = owner = forget_ended = true;
    if (ask.of == Request::Kind::disarm) armed = owner = false;
  }
  if (!good) set_lost({std::string("`") + ask.name + "` was answered by something else", false});
}

void ServerSession::handle_welcome(double now) {
  if (welcome.protocol[0] != wire::MAJOR) return reject(version_refusal(welcome.protocol[0]));
  request_capabilities(now);
}

/// Ends the session because the server rejects the client. Reports each reason once, although the client tries again.
void ServerSession::reject(const Refusal& refusal) {
  const std::string field = refusal.path.empty() ? "" : " (" + refusal.path + ")";
  const std::string why = refusal.message + field + (refusal.advice.empty() ? "" : ": " + refusal.advice);
  if (!loss_.refused || loss_.why != why) add_event(Event::Kind::refused, refusal);
  set_lost({why, true});
}

void ServerSession::handle_error(const wire::Error& error, const Ask* ask) {
  const Refusal refusal = refusal_of(error);
  if (ask && ask->callback) events.push_back({Event::Kind::field, {}, 0, ask->callback, {}});
  if (ask && ask->kind == Ask::Kind::hello) return reject(refusal);
  if (error.code == wire::Code::session) return set_lost({refusal.message, false});
  if (!ask && error.id == 0 && ends_sound(error.code)) {
    armed = false;
    return add_event(Event::Kind::ended, refusal);
  }
  add_event(Event::Kind::refused, refusal);
}

void ServerSession::handle_renewal(const wire::Renewed& reply, double now) {
  if (!connected()) return;
  armed = reply.armed;
  owner = reply.owner;
  const Sent& sent = sent_[static_cast<std::size_t>(reply.id) % sent_.size()];
  if (reply.id == 0 || sent.id != reply.id) return;
  server_clock.add_round_trip(sent.at, now);
  server_clock.add_mark(sent.at, now, reply.server_time);
}

}  // namespace pacinian::client
