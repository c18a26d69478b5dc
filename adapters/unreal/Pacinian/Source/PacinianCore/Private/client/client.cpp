#include <algorithm>
#include <complex>
#include <cstdio>
#include <utility>

#include "client_impl.h"
#include "pacinian/wire/bulk.h"

namespace pacinian {

using client::Event;

namespace {

Refusal unstopped(const std::string& problem) {
  return {"stop", "the stop was not confirmed: " + problem, "", "`pacinian stop`, or switch the array off"};
}

/// True until the end of the block, also if a handler throws.
struct During {
  explicit During(bool& set) : value(set) { value = true; }
  ~During() { value = false; }
  During(const During&) = delete;
  During& operator=(const During&) = delete;
  bool& value;
};

template <class T>
T take_first(std::vector<T>& from) {
  T first = std::move(from.front());
  from.erase(from.begin());
  return first;
}

}  // namespace

Client::Impl::Impl(Options given)
    : options(std::move(given)), emergency_stop(options, [this](const std::string& why) { stopped(why); }) {}

Client::Client(Options options) : in_(std::make_unique<Impl>(std::move(options))) {}

Client::~Client() { close(); }

void Client::start() {
  if (in_->worker) return;
  auto worker = std::make_unique<client::Worker>(in_->options, in_->emergency_stop);
  const std::lock_guard<std::mutex> guard(in_->lock);
  in_->worker = std::move(worker);
  in_->view.status = Status::connecting;
}

void Client::close() {
  std::unique_ptr<client::Worker> ended;
  {
    const std::lock_guard<std::mutex> guard(in_->lock);
    ended = std::move(in_->worker);
  }
  in_->view = {};
  in_->session = 0;
  in_->has_state = false;
  in_->touches.clear();
  in_->events.clear();
  ++in_->closed;
}

void Client::stop(std::function<void(const Refusal&)> refused) {
  {
    const std::lock_guard<std::mutex> guard(in_->lock);
    in_->stop_refused = std::move(refused);
  }
  in_->emergency_stop.stop();
}

void Client::Impl::stopped(const std::string& problem) {
  std::function<void(const Refusal&)> refused;
  {
    const std::lock_guard<std::mutex> guard(lock);
    if (worker) worker->mailbox().wake.set();
    stop_problem = problem;
    refused = std::move(stop_refused);
    stop_refused = nullptr;
  }
  if (!problem.empty() && refused) refused(unstopped(problem));
}

void Client::tick() {
  Impl& in = *in_;
  if (in.ticks) return;  // called by an event handler
  const During during(in.ticks);
  in.thread = std::this_thread::get_id();
  const int closed = in.closed;
  bool newer = false;
  std::string problem, wrong;
  if (in.worker) {
    const auto pause = in.worker->mailbox().record_tick(in.options.clock());
    const bool stood = in.view.armed && pause.game > in.view.lease;
    newer = in.worker->mailbox().take_updates(in.view, in.events, in.state);
    if (stood && !in.is_lost() && on.stood_still) on.stood_still({pause.game, pause.worker > 0.75 * pause.game});
  }
  {
    const std::lock_guard<std::mutex> guard(in.lock);
    std::swap(problem, in.stop_problem);
    std::swap(wrong, in.wrong_call);
  }
  if (!problem.empty()) in.refusals.push_back(unstopped(problem));
  if (!wrong.empty())
    in.refusals.push_back({"thread", "`" + wrong + "` was called from another thread than `tick`, and did nothing", "",
                           "call it from the thread that calls tick; only stop may be called from any"});
  for (std::size_t left = in.refusals.size(); left > 0; --left) {
    const Refusal refusal = take_first(in.refusals);
    if (on.refused) on.refused(refusal);
  }
  while (!in.events.empty() && in.closed == closed) {
    Event event = take_first(in.events);
    in.dispatch(event, on);
  }
  in.has_state = (in.has_state || newer) && in.closed == closed;
  if (newer && in.has_state) {
    in.touches.report_changes(in.state.scene == in.view.scene ? &in.state : nullptr, on);
    if (in.has_state && in.closed == closed && on.state_changed) on.state_changed(in.state);
  }
}

/// Returns whether the session that the game knows has ended.
bool Client::Impl::is_lost() const {
  return std::any_of(events.begin(), events.end(), [](const Event& event) { return event.kind == Event::Kind::lost; });
}

void Client::Impl::dispatch(Event& event, const Events& on) {
  const Refusal& refusal = event.refusal;
  switch (event.kind) {
    case Event::Kind::connected:
      session = event.session;
      has_state = told_no_session = false;
      if (on.connected) on.connected();
      break;
    case Event::Kind::lost:
      session = 0;
      has_state = false;
      touches.report_changes(nullptr, on);
      if (on.lost) on.lost(refusal.message);
      break;
    case Event::Kind::ended:
      if (on.ended) on.ended(refusal);
      break;
    case Event::Kind::refused:
      if (on.refused) on.refused(refusal);
      break;
    case Event::Kind::field: {
      std::vector<std::complex<float>> pressures(event.pressures.size() / 8);
      for (std::size_t i = 0; i < pressures.size(); ++i)
        pressures[i] = {wire::float_at(event.pressures, 2 * i),
                        wire::float_at(event.pressures, 2 * i + 1)};
      if (event.callback) event.callback(pressures);
      break;
    }
  }
}

Status Client::status() const { return in_->view.status; }
const std::string& Client::problem() const { return in_->view.problem; }
bool Client::armed() const { return in_->view.armed; }
bool Client::owner() const { return in_->view.owner; }
double Client::lease() const { return in_->view.lease; }
double Client::latency() const { return in_->view.round_trips.median; }
RoundTrips Client::round_trips() const { return in_->view.round_trips; }
double Client::offset() const { return in_->view.offset; }
double Client::now() const { return in_->options.clock(); }
double Client::age(const wire::State& state) const { return now() + offset() - state.time; }
const std::string& Client::scene() const { return in_->view.scene; }
const std::string& Client::server() const { return in_->view.server; }
const wire::Abilities* Client::capabilities() const { return in_->view.abilities.get(); }
const wire::State* Client::state() const { return in_->has_state ? &in_->state : nullptr; }
const std::vector<wire::TouchState>& Client::touches() const { return in_->touches.now(); }
RegionFelt Client::felt(std::string_view name) const { return RegionFelt::of(state(), name); }

std::string Refusal::text() const {
  return code + ": " + message + (path.empty() ? "" : " (" + path + ")") + (advice.empty() ? "" : "; " + advice);
}

std::string Standstill::text() const {
  char figures[32];
  std::snprintf(figures, sizeof figures, "%.1f", seconds);
  const char* what = whole ? "the program stood still (a breakpoint, or the computer slept)" : "the game did not tick";
  return std::string(what) + " for " + figures + " s, so it was silent meanwhile";
}

}  // namespace pacinian
