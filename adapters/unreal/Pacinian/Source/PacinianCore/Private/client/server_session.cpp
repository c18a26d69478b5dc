#include "server_session.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace pacinian::client {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double quiet = 2.0;  // [s] without a sign of life: four times the usual interval

ConnectionFailure hangs(const char* what, double seconds) {
  char text[100];
  std::snprintf(text, sizeof text, "no answer to `%s` within %g s: the server hangs", what, seconds);
  return {text, false};
}

}  // namespace

std::int64_t ServerSession::next_id() { return ids_ = ids_ % 0xFFFFFFFF + 1; }

template <class Message>
ServerSession::Ask& ServerSession::queue_message(Ask::Kind kind, Message& message, double now, double timeout) {
  message.id = next_id();
  asks_.push_back({kind, Request::Kind::arm, Message::tag.data(), message.id, timeout, now + timeout,
                   {}, false, {}});
  asks_.back().message.put(message);
  return asks_.back();
}

void ServerSession::begin(double now) {
  end();
  phase_ = Phase::greeting;
  sequence_ = 0;
  lost_ = unreadable_ = false;
  renewed_ = ticked_;  // only later ticks count
  heard_ = now;
  server_clock = ServerClock();
  sent_.fill({});
  queue_message(Ask::Kind::hello, hello_, now, timeout_);
}

void ServerSession::end() {
  for (Ask& ask : asks_)
    if (ask.callback) events.push_back({Event::Kind::field, {}, 0, std::move(ask.callback), {}});
  asks_.clear();
  abilities.reset();
  armed = owner = false;
  phase_ = Phase::none;
}

void ServerSession::set_lost(ConnectionFailure loss) {
  if (lost_) return;
  lost_ = true;
  loss_ = std::move(loss);
  if (connected()) {
    loss_.why += "; nothing of this session goes on";
    add_event(Event::Kind::lost, {"", loss_.why, "", ""});
  }
  end();
}

void ServerSession::add_request(Request request, double now) {
  const auto send = [&](auto message, double timeout) {
    message.session = welcome.session;
    queue_message(Ask::Kind::request, message, now, timeout);
  };
  wire::Arm arm;
  arm.take = request.take;
  arm.resume = request.resume;
  switch (request.kind) {
    case Request::Kind::arm:
      send(arm, timeout_);
      break;
    case Request::Kind::disarm:
      send(wire::Disarm{}, timeout_);
      break;
    case Request::Kind::reset:
      send(wire::Reset{}, timeout_);
      break;
    case Request::Kind::select:
      send(std::move(request.choice), change);
      break;
    case Request::Kind::field:
      request.field.session = welcome.session;
      request.field.sequence = ++sequence_;
      request.field.time = now;
      queue_message(Ask::Kind::field, request.field, now, timeout_).callback = std::move(request.callback);
      break;
  }
  asks_.back().of = request.kind;
}

void ServerSession::request_capabilities(double now) {
  phase_ = Phase::asking;
  wire::Capabilities message;
  message.session = welcome.session;
  queue_message(Ask::Kind::capabilities, message, now, timeout_);
}

void ServerSession::send_requests(double now, MessageSink& outlet) {
  bool held = false;
  for (Ask& ask : asks_) {
    const bool command = ask.kind == Ask::Kind::field;
    held = held || (holds_ && ask.of == Request::Kind::reset);
    if (held && !command) ask.deadline = now + ask.timeout;
    if (ask.sent || (held && !command)) continue;
    ask.sent = command ? outlet.send_command(ask.message) : outlet.send_control(ask.message);
    if (!ask.sent && !command) return;
    if (ask.kind == Ask::Kind::hello) sent_[0] = {ask.id, now};
  }
  if (renewal_due(now) && !wants_tick(now)) renew(now, outlet);
}

bool ServerSession::renewal_due(double now) const { return phase_ == Phase::connected && now >= due_; }

bool ServerSession::wants_tick(double now) const { return renewal_due(now) && ticked_ <= renewed_; }

void ServerSession::renew(double now, MessageSink& outlet) {
  renew_.session = welcome.session;
  renew_.id = next_id();
  renew_.sequence = ++sequence_;
  renew_.time = ticked_;  // the lease counts from this time
  writer_.clear();
  writer_.put(renew_);
  due_ = now + renewal_share * welcome.lease;
  if (!outlet.send_control(writer_)) return;
  sent_[static_cast<std::size_t>(renew_.id) % sent_.size()] = {renew_.id, now};
  renewed_ = ticked_;
}

bool ServerSession::send_commands(Outbox& outbox, double now, MessageSink& outlet) {
  if (!connected()) return true;
  CommandSender courier{outlet, welcome.session, sequence_, writer_};
  const bool all = outbox.flush(now, courier);
  return all;
}

void ServerSession::say_goodbye(MessageSink& outlet) {
  if (!connected()) return;
  wire::Bye message;
  message.session = welcome.session;
  end();
  outlet.send_control(queue_message(Ask::Kind::request, message, 0.0, never).message);
  phase_ = Phase::leaving;
}

void ServerSession::check_timeouts(double now) {
  for (const Ask& ask : asks_)
    if (now >= ask.deadline) return set_lost(hangs(ask.name, ask.timeout));
  if (connected() && now >= heard_ + std::max(timeout_, quiet))
    set_lost(hangs(wire::Renew::tag.data(), std::max(timeout_, quiet)));
}

double ServerSession::due(double now) const {
  double due = connected() ? heard_ + std::max(timeout_, quiet) : never;
  for (const Ask& ask : asks_) due = std::min(due, ask.deadline);
  if (connected() && !wants_tick(now)) due = std::min(due, due_);
  return due;
}

}  // namespace pacinian::client
