#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "wake_event.h"
#include "outbox.h"
#include "worker_messages.h"

namespace pacinian::client {

/// Passes messages between the game's thread and the worker. The lock is never held during a wait, or during input or
/// output.
class Mailbox {
 public:
  /// Ends the worker's wait.
  WakeEvent wake;

  // The game's side.

  /// Calls `act` with what is to be sent, if `session` is still the present one.
  template <class Act>
  bool change_outgoing(std::uint64_t session, Act act) {
    {
      const std::lock_guard<std::mutex> guard(lock_);
      if (session == 0 || session != session_) return false;
      act(*filling_, requests_);
    }
    wake.set();
    return true;
  }

  /// How long the game has not ticked, and the longest time within it in which the worker did not run [s].
  struct Pause {
    double game, worker;
  };

  /// Records a tick of the game at `time` [s].
  Pause record_tick(double time) {
    const double before = ticked_.exchange(time), longest = longest_step_.exchange(0.0);
    if (wants_tick_.exchange(false)) wake.set();
    return {time - before, std::max(longest, time - stepped_.load())};
  }

  /// Takes the status and state since the last call, and appends the events. Returns whether there is a newer state.
  bool take_updates(SessionStatus& view, std::vector<Event>& events, wire::State& state) {
    const std::lock_guard<std::mutex> guard(lock_);
    for (Event& event : events_) events.push_back(std::move(event));
    events_.clear();
    if (std::exchange(viewed_, false)) view = status_;
    if (!std::exchange(fresh_, false)) return false;
    std::swap(state, state_);
    return true;
  }

  // The worker's side.

  double last_tick() const { return ticked_.load(); }

  /// Records a step of the worker at `time` [s].
  void record_step(double time) {
    const double since = time - stepped_.exchange(time);
    if (since > longest_step_.load()) longest_step_.store(since);
  }

  void request_tick() { wants_tick_.store(true); }

  /// Moves what is to be sent to `box` and `requests`.
  void take_outgoing(Outbox*& box, std::vector<Request>& requests) {
    const std::lock_guard<std::mutex> guard(lock_);
    if (box->empty())
      std::swap(box, filling_);
    else
      box->take(*filling_);
    for (Request& request : requests_) requests.push_back(std::move(request));
    requests_.clear();
  }

  /// Starts a session, to which commands and requests from now on belong; 0: none.
  void start_session(std::uint64_t session) {
    const std::lock_guard<std::mutex> guard(lock_);
    session_ = session;
    filling_->forget();
    for (Request& request : requests_)
      if (request.callback) events_.push_back({Event::Kind::field, {}, 0, std::move(request.callback), {}});
    requests_.clear();
    fresh_ = false;
  }

  /// Adds events. If there are too many, the oldest that the game has not taken are dropped. A session that begins and
  /// ends between two ticks is not reported.
  void add_events(std::vector<Event>& events, bool forget_ended) {
    const std::lock_guard<std::mutex> guard(lock_);
    for (std::size_t i = events_.size(); forget_ended && i-- > 0;)
      if (events_[i].kind == Event::Kind::ended)
        events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(i));
    for (Event& event : events) {
      if (event.kind == Event::Kind::lost && drop_connected()) continue;
      if (events_.size() >= most) events_.erase(events_.begin());
      events_.push_back(std::move(event));
    }
    events.clear();
  }

  void set_status(const SessionStatus& view) {
    const std::lock_guard<std::mutex> guard(lock_);
    status_ = view;
    viewed_ = true;
  }

  /// Swaps in a newer state.
  void publish_state(wire::State& state) {
    const std::lock_guard<std::mutex> guard(lock_);
    std::swap(state, state_);
    fresh_ = true;
  }

  Outbox* first_outbox() { return &boxes_[1]; }

 private:
  static constexpr std::size_t most = 200;  ///< events

  /// Drops the event that a session has begun. Returns false if the game has taken it.
  bool drop_connected() {
    const auto begun = std::find_if(events_.begin(), events_.end(),
                                    [](const Event& event) { return event.kind == Event::Kind::connected; });
    if (begun == events_.end()) return false;
    events_.erase(begun);
    return true;
  }

  std::mutex lock_;
  Outbox boxes_[2];
  Outbox* filling_ = &boxes_[0];
  std::vector<Request> requests_;
  std::uint64_t session_ = 0;
  std::vector<Event> events_;
  SessionStatus status_;
  wire::State state_;
  bool viewed_ = false, fresh_ = false;
  std::atomic<double> ticked_{-1e300}, longest_step_{0.0};
  std::atomic<double> stepped_{std::numeric_limits<double>::quiet_NaN()};
  std::atomic<bool> wants_tick_{false};
};

}  // namespace pacinian::client
