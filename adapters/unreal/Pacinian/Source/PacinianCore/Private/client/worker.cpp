#include "worker.h"

#include <algorithm>

namespace pacinian::client {

namespace {

constexpr double max_wait = 0.1;         // [s] between two steps
constexpr double max_fresh_age = 0.05;   // [s] of a state, beyond which newer ones are looked for
constexpr double settling_time = 0.005;  // [s] in which more would come

}  // namespace

Worker::Worker(const Options& options, Stopper& stopper)
    : options_(options),
      stopper_(stopper),
      dialogue_(introduce(options), options.timeout),
      outbox_(mailbox_.first()),
      thread_([this] { run(); }) {}

Worker::~Worker() {
  quits_.store(true);
  mailbox_.bell.ring();
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
    if (!transport_ && now >= attempts_.due()) connect(now);
    if (transport_) speak(now);
    tell(now);
    wait(now);
    if (transport_) hear();
  }
  leave();
}

void Worker::speak(double now) {
  dialogue_.tick(mailbox_.ticked());
  mailbox_.take(outbox_, requests_);
  dialogue_.hold_resets(stopper_.busy());  // after take: a stop called before a reset that it took is busy
  for (Request& request : requests_) dialogue_.ask(std::move(request), now);
  requests_.clear();
  dialogue_.speak(now, *this);
  dialogue_.flush(*outbox_, now, *this);
}

void Worker::hear() {
  for (const Channel channel : {Channel::control, Channel::command})
    while (transport_->receive(channel, message_))
      dialogue_.hear(message_.data(), message_.size(), options_.clock());
  notice();
  look();
  dialogue_.pass_time(options_.clock());
}

void Worker::notice() {
  const End end = transport_->ended();
  if (end.how != Ending::none)
    dialogue_.lose(explain(end.how, connection_.at(end.where), dialogue_.begun()));
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
    dialogue_.unreadable(wrong.problem);
  auto* state = std::get_if<wire::State>(&incoming_);
  if (held_ == never || !state) return;
  if (now < held_ + settling_time && dialogue_.timing.age(state->time, now) > max_fresh_age) return;
  if (dialogue_.connected()) mailbox_.publish(*state);
  held_ = never;
}

/// Lets the game's thread know.
void Worker::tell(double now) {
  for (Event& event : dialogue_.events)
    if (event.kind == Event::Kind::connected) {
      attempts_.succeeded();
      stopper_.remember(connection_);
      event.session = ++sessions_;
      mailbox_.begin(sessions_);
    }
  if (transport_ && dialogue_.loss()) {
    mailbox_.begin(0);
    disconnect();
    attempts_.failed(*dialogue_.loss(), now);
  }
  if (!dialogue_.events.empty()) mailbox_.report(dialogue_.events, dialogue_.forget_ended);
  dialogue_.forget_ended = false;
  show();
}

void Worker::show() {
  view_.status = attempts_.status();
  view_.problem = attempts_.problem();
  view_.armed = dialogue_.armed && dialogue_.owner;
  view_.owner = dialogue_.owner;
  view_.trips = dialogue_.timing.trips();
  view_.offset = dialogue_.timing.offset();
  view_.abilities = dialogue_.abilities;
  view_.lease = dialogue_.welcome.lease;
  view_.scene = dialogue_.welcome.scene;
  view_.server = dialogue_.welcome.server;
  mailbox_.show(view_);
}

void Worker::wait(double now) {
  double due = now + max_wait;
  if (transport_) {
    due = std::min({due, dialogue_.due(now), held_ + settling_time});
    if (dialogue_.wants_tick(now)) {
      mailbox_.want_tick();
      if (mailbox_.ticked() != dialogue_.ticked()) return;
    }
  } else {
    due = std::min(due, attempts_.due());
  }
  const double left = std::max(0.0, due - options_.clock());
  if (transport_)
    transport_->wait(left, &mailbox_.bell);
  else
    mailbox_.bell.wait(left);
  mailbox_.bell.clear();
}

}  // namespace pacinian::client
