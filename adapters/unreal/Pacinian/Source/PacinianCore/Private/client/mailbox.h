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

/// What the game's thread and the worker leave for each other. The lock is never held while anything is waited for,
/// sent, read or written.
class Mailbox {
 public:
  /// Ends the worker's wait.
  WakeEvent wake;

  // The game's side.

  /// Does something with what is to be sent, if `session` is still the one there is.
  template <class Act>
  bool tell(std::uint64_t session, Act act) {
    {
      const std::lock_guard<std::mutex> guard(lock_);
      if (session == 0 || session != session_) return false;
      act(*filling_, requests_);
    }
    wake.set();
    return true;
  }

  /// How long the game has not ticked, and the longest of that time in which the worker did not run [s].
  struct Pause {
    double game, worker;
  };

  /// The game is alive at `time` [s].
  Pause tick(double time) {
    const double before = ticked_.exchange(time), longest = longest_step_.exchange(0.0);
    if (wants_tick_.exchange(false)) wake.set();
    return {time - before, std::max(longest, time - stepped_.load())};
  }

  /// Takes what has been told since. True if there is a newer state.
  bool collect(SessionStatus& view, std::vector<Event>& events, wire::State& state) {
    const std::lock_guard<std::mutex> guard(lock_);
    std::swap(events, events_);
    if (std::exchange(viewed_, false)) view = status_;
    if (!std::exchange(fresh_, false)) return false;
    std::swap(state, state_);
    return true;
  }

  // The worker's side.

  double ticked() const { return ticked_.load(); }

  /// The worker runs at `time` [s].
  void step(double time) {
    const double since = time - stepped_.exchange(time);
    if (since > longest_step_.load()) longest_step_.store(since);
  }

  void want_tick() { wants_tick_.store(true); }

  /// Adds what is to be sent to `box` and `requests`.
  void take(Outbox*& box, std::vector<Request>& requests) {
    const std::lock_guard<std::mutex> guard(lock_);
    if (box->empty())
      std::swap(box, filling_);
    else
      box->take(*filling_);
    for (Request& request : requests_) requests.push_back(std::move(request));
    requests_.clear();
  }

  /// From now on what is told is for that session; 0: for none.
  void begin(std::uint64_t session) {
    const std::lock_guard<std::mutex> guard(lock_);
    session_ = session;
    filling_->forget();
    for (Request& request : requests_)
      if (request.told) events_.push_back({Event::Kind::field, {}, 0, std::move(request.told), {}});
    requests_.clear();
    fresh_ = false;
  }

  /// Adds events, in place of those that the game has not taken if there are too many.
  void report(std::vector<Event>& events, bool forget_ended) {
    const std::lock_guard<std::mutex> guard(lock_);
    for (std::size_t i = events_.size(); forget_ended && i-- > 0;)
      if (events_[i].kind == Event::Kind::ended)
        events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(i));
    for (Event& event : events) {
      if (events_.size() >= most) events_.erase(events_.begin());
      events_.push_back(std::move(event));
    }
    events.clear();
  }

  void show(const SessionStatus& view) {
    const std::lock_guard<std::mutex> guard(lock_);
    status_ = view;
    viewed_ = true;
  }

  /// Swaps in a newer state.
  void publish(wire::State& state) {
    const std::lock_guard<std::mutex> guard(lock_);
    std::swap(state, state_);
    fresh_ = true;
  }

  Outbox* first() { return &boxes_[1]; }

 private:
  static constexpr std::size_t most = 200;  ///< events

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
