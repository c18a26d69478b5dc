#include "worker.h"

#include <algorithm>

namespace pacinian::client {

namespace {

constexpr double max_wait = 0.1;         // [s] between two steps
constexpr double max_fresh_age = 0.05;   // [s] age of a state beyond which newer ones are looked for
constexpr double settling_time = 0.005;  // [s] in which more states would arrive

}  // namespace

Worker::Worker(const Options& options, EmergencyStop& emergency_stop)
    : options_(options),
      emergency_stop_(emergency_stop),
      session_(make_hello(options), options.timeout),
      outbox_(mailbox_.first_outbox()),
      thread_([this] { run(); }) {}

Worker::~Worker() {
  quits_.store(true);
  mailbox_.wake.set();
  thread_.join();
}

bool Worker::send_control(const wire::Writer& message) {
  return transport_->send(Channel::control, message.data(), message.size());
}

bool Worker::send_command(const wire::Writer& message) {
  return transport_->send(Channel::command, message.data(), message.size());
}

void Worker::run() {
  while (!quits_.load()) {
    const double now = options_.clock();
    mailbox_.record_step(now);
    if (!transport_ && now >= backoff_.due()) connect(now);
    if (transport_) send_messages(now);
    report_events(now);
    wait_for_work(now);
    if (transport_) receive_messages();
  }
  say_goodbye();
}

void Worker::send_messages(double now) {
  session_.record_tick(mailbox_.last_tick());
  mailbox_.take_outgoing(outbox_, requests_);
  session_.hold_resets(emergency_stop_.busy());  // after take_outgoing: a stop called before a reset counts as busy
  for (Request& request : requests_) session_.add_request(std::move(request), now);
  requests_.clear();
  session_.send_requests(now, *this);
  session_.send_commands(*outbox_, now, *this);
}

void Worker::receive_messages() {
  for (const Channel channel : {Channel::control, Channel::command})
    while (transport_->receive(channel, message_))
      session_.handle_message(message_.data(), message_.size(), options_.clock());
  check_connection();
  receive_state();
  session_.check_timeouts(options_.clock());
}

void Worker::check_connection() {
  const End end = transport_->ended();
  if (end.how != Ending::none)
    session_.set_lost(explain(end.how, connection_.at(end.where), session_.begun()));
}

/// Decodes only the newest state that has arrived. A slow reader finds old states in the kernel's buffers, which refill
/// as it reads. Therefore an old state is held until no more arrive.
void Worker::receive_state() {
  bool some = false;
  while (transport_->receive(Channel::state, message_)) some = true;
  const double now = options_.clock();
  wire::WireError wrong;
  if (some && wire::decode_state(message_.data(), message_.size(), incoming_, wrong))
    held_ = now;
  else if (some)
    session_.report_unreadable(wrong.problem);
  auto* state = std::get_if<wire::State>(&incoming_);
  if (held_ == never || !state) return;
  if (now < held_ + settling_time && session_.server_clock.age(state->time, now) > max_fresh_age) return;
  if (session_.connected()) mailbox_.publish_state(*state);
  held_ = never;
}

/// Passes events and the status to the game's thread.
void Worker::report_events(double now) {
  for (Event& event : session_.events)
    if (event.kind == Event::Kind::connected) {
      backoff_.record_success();
      emergency_stop_.remember(connection_);
      event.session = ++sessions_;
      mailbox_.start_session(sessions_);
    }
  if (transport_ && session_.loss()) {
    mailbox_.start_session(0);
    disconnect();
    backoff_.record_failure(*session_.loss(), now);
  }
  if (!session_.events.empty()) mailbox_.add_events(session_.events, session_.forget_ended);
  session_.forget_ended = false;
  publish_status();
}

void Worker::publish_status() {
  status_.status = backoff_.status();
  status_.problem = backoff_.problem();
  status_.armed = session_.armed && session_.owner;
  status_.owner = session_.owner;
  status_.round_trips = session_.server_clock.round_trips();
  status_.offset = session_.server_clock.offset();
  status_.abilities = session_.abilities;
  status_.lease = session_.welcome.lease;
  status_.scene = session_.welcome.scene;
  status_.server = session_.welcome.server;
  mailbox_.set_status(status_);
}

void Worker::wait_for_work(double now) {
  double due = now + max_wait;
  if (transport_) {
    due = std::min({due, session_.due(now), held_ + settling_time});
    if (session_.wants_tick(now)) {
      mailbox_.request_tick();
      if (mailbox_.last_tick() != session_.last_tick()) return;
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
