#include "worker.h"

#include <algorithm>
#include <cmath>

namespace pacinian::client {

namespace {

constexpr double longest = 1.0;   // [s] between two looks at the clock
constexpr double fresh = 0.05;    // [s] of a state's age, beyond which newer ones are looked for
constexpr double settle = 0.005;  // [s] in which more would come

constexpr short both = ZMQ_POLLIN | ZMQ_POLLOUT;

zmq_pollitem_t item(void* socket, short events = ZMQ_POLLIN) { return {socket, 0, events, 0}; }

}  // namespace

Worker::Worker(const Options& options, Stopper& stopper)
    : options_(options),
      stopper_(stopper),
      mailbox_(context_),
      dialogue_(introduce(options), options.timeout),
      outbox_(mailbox_.first()),
      thread_([this] { run(); }) {}

Worker::~Worker() {
  quits_.store(true);
  mailbox_.wake.signal();
  thread_.join();
}

bool Worker::control(const wire::Writer& message) {
  control_full_ = !control_.send(message.data(), message.size());
  return !control_full_;
}

bool Worker::command(const wire::Writer& message) {
  command_full_ = !command_.send(message.data(), message.size());
  return !command_full_;
}

void Worker::run() {
  while (!quits_.load()) {
    const double now = options_.clock();
    if (!open_ && now >= attempts_.due()) connect(now);
    if (open_) speak(now);
    tell(now);
    wait(now);
    if (open_) hear();
  }
  leave();
}

void Worker::speak(double now) {
  dialogue_.tick(mailbox_.ticked());
  mailbox_.take(outbox_, requests_);
  dialogue_.hold_resets(stopper_.busy());  // after take: a stop called before a reset that it took is busy
  for (Request& request : requests_) dialogue_.ask(std::move(request), now);
  requests_.clear();
  control_full_ = command_full_ = false;
  dialogue_.speak(now, *this);
  dialogue_.flush(*outbox_, now, *this);
}

void Worker::hear() {
  Message message;
  for (Link* link : {&control_, &command_})
    while (link->receive(message)) dialogue_.hear(message.data(), message.size(), options_.clock());
  for (Link* link : {&control_, &command_}) notice(*link);
  look();
  dialogue_.pass_time(options_.clock());
}

void Worker::notice(Link& link) {
  Loss loss;
  if (link.lost(loss, dialogue_.begun())) dialogue_.lose(loss);
}

/// Of the states that have come only the newest is read. A reader that was slow finds old ones in the kernel's
/// buffers, more of which come only as it reads: an old one is held until no more come.
void Worker::look() {
  Message newest, next;
  bool some = false;
  while (states_.receive(next)) some = zmq_msg_move(newest.get(), next.get()) == 0;
  const double now = options_.clock();
  wire::WireError wrong;
  if (some && wire::decode_state(newest.data(), newest.size(), incoming_, wrong))
    held_ = now;
  else if (some)
    dialogue_.unreadable(wrong.problem);
  auto* state = std::get_if<wire::State>(&incoming_);
  if (held_ == never || !state) return;
  if (now < held_ + settle && dialogue_.timing.age(state->time, now) > fresh) return;
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
  if (open_ && dialogue_.loss()) {
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
  double due = now + longest;
  zmq_pollitem_t items[6] = {item(mailbox_.wake.socket())};
  int count = 1;
  if (open_) {
    due = std::min({due, dialogue_.due(now), held_ + settle});
    if (dialogue_.wants_tick(now)) {
      mailbox_.want_tick();
      if (mailbox_.ticked() != dialogue_.ticked()) return;
    }
    items[count++] = item(control_.socket(), control_full_ ? both : ZMQ_POLLIN);
    items[count++] = item(control_.monitor());
    items[count++] = item(command_.socket(), command_full_ ? both : ZMQ_POLLIN);
    items[count++] = item(command_.monitor());
    items[count++] = item(states_.get());
  } else {
    due = std::min(due, attempts_.due());
  }
  const double left = std::max(0.0, due - options_.clock());
  zmq_poll(items, count, static_cast<long>(std::ceil(1e3 * left)));
  mailbox_.wake.clear();
}

}  // namespace pacinian::client
