#include "worker.h"

#include <algorithm>

namespace pacinian::client {

namespace {

constexpr double max_wait = 0.1;         // [s] between two steps
constexpr double max_fresh_age = 0.05;   // [s] of a state, beyond which newer ones are looked for
constexpr double settling_time = 0.005;  // [s] in which more would come

}  // namespace

Worker::Worker(const Options& options, EmergencyStop& emergency_stop)
    : options_(options),
      emergency_stop_(emergency_stop),
      session_(introduce(options), options.timeout),
      outbox_(mailbox_.first()),
      thread_([this] { run(); }) {}

Worker::~Worker() {
  quits_.store(true);
  mailbox_.wake.set();
  thread_.join();
}

bool Worker::control(const wire::Writer& message) {
  return transport_->send(Channel::control, message.data(), message.size());
}

bool Worker::command(const wire::Writer& message) {
  return transport_->send(Channel::command, message.data(), message.size());
}

void Worker::run() {
  while (!quits_.load()) {
    const double now = options_.clock();
    mailbox_.step(now);
    if (!transport_ && now >= backoff_.due()) connect(now);
    if (transport_) speak(now);
    tell(now);
    wait(now);
    if (transport_) hear();
  }
  leave();
}

void Worker::speak(double now) {
  session_.tick(mailbox_.ticked());
  mailbox_.take(outbox_, requests_);
  session_.hold_resets(emergency_stop_.busy());  // after take: a stop called before a reset that it took is busy
  for (Request& request : requests_) session_.ask(std::move(request), now);
  requests_.clear();
  session_.speak(now, *this);
  session_.flush(*outbox_, now, *this);
}

void Worker::hear() {
  for (const Channel channel : {Channel::control, Channel::command})
    while (transport_->receive(channel, message_))
      session_.hear(message_.data(), message_.size(), options_.clock());
  notice();
  look();
  session_.pass_time(options_.clock());
}

void Worker::notice() {
  const End end = transport_->ended();
  if (end.how != Ending::none)
    session_.lose(explain(end.how, connection_.at(end.where), session_.begun()));
}

/// Of the states that have come only the newest is read. A reader that was slow finds old ones in the kernel's
/// buffers, more of which come only as it reads: an old one is held until no more come.
void Worker::look() {
  bool some = false;
  while (transport_->receive(Channel::state, message_)) some = true;
  const double now = options_.clock();
  wire::WireError wrong;
  if (some && wire::decode_state(message_.data(), message_.size(), incoming_, wrong))
    held_ = now;
  else if (some)
    session_.unreadable(wrong.problem);
  auto* state = std::get_if<wire::State>(&incoming_);
  if (held_ == never || !state) return;
  if (now < held_ + settling_time && session_.timing.age(state->time, now) > max_fresh_age) return;
  if (session_.connected()) mailbox_.publish(*state);
  held_ = never;
}

/// Lets the game's thread know.
void Worker::tell(double now) {
  for (Event& event : session_.events)
    if (event.kind == Event::Kind::connected) {
      backoff_.succeeded();
      emergency_stop_.remember(connection_);
      event.session = ++sessions_;
      mailbox_.begin(sessions_);
    }
  if (transport_ && session_.loss()) {
    mailbox_.begin(0);
    disconnect();
    backoff_.failed(*session_.loss(), now);
  }
  if (!session_.events.empty()) mailbox_.report(session_.events, session_.forget_ended);
  session_.forget_ended = false;
  show();
}

void Worker::show() {
  status_.status = backoff_.status();
  status_.problem = backoff_.problem();
  status_.armed = session_.armed && session_.owner;
  status_.owner = session_.owner;
  status_.trips = session_.timing.trips();
  status_.offset = session_.timing.offset();
  status_.abilities = session_.abilities;
  status_.lease = session_.welcome.lease;
  status_.scene = session_.welcome.scene;
  status_.server = session_.welcome.server;
  mailbox_.show(status_);
}

void Worker::wait(double now) {
  double due = now + max_wait;
  if (transport_) {
    due = std::min({due, session_.due(now), held_ + settling_time});
    if (session_.wants_tick(now)) {
      mailbox_.want_tick();
      if (mailbox_.ticked() != session_.ticked()) return;
    }
  } else {
    due = std::min(due, backoff_.due());
  }
  const double left = std::max(0.0, due - options_.clock());
  if (transport_)
    transport_->wait(left, &mailbox_.wake);
  else
    mailbox_.wake.wait(left);
  mailbox_.wake.clear();
}

}  // namespace pacinian::client
