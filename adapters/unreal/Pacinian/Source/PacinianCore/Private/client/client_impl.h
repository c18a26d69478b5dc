#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "pacinian/client.h"
#include "emergency_stop.h"
#include "touches.h"
#include "worker.h"

namespace pacinian {

/// The game's side of a client.
struct Client::Impl {
  explicit Impl(Options given);

  template <class Act>
  bool tell(Act act);
  template <class Act>
  bool command(Act act);
  bool ask(client::Request request);
  bool report_no_session(const char* what, bool done);
  bool is_games_thread(const char* call);
  bool is_lost() const;
  double max_pressure() const;
  void dispatch(client::Event& event, const Events& on);
  void stopped(const std::string& problem);

  const Options options;
  client::SessionStatus view;
  std::vector<client::Event> events;
  wire::State state;
  client::Touches touches;
  std::vector<Refusal> refusals;  ///< from the client itself
  bool has_state = false, ticks = false, told_no_session = false;
  std::uint64_t session = 0;  ///< that the game knows; 0: none
  int closed = 0;             ///< how often the client was closed

  std::mutex lock;  ///< protects what stops from other threads use
  std::unique_ptr<client::Worker> worker;
  std::string stop_problem;
  std::function<void(const Refusal&)> stop_refused;  ///< of the last stop
  std::string wrong_call;  ///< from another thread than the game's
  bool told_thread = false;
  std::atomic<std::thread::id> thread{std::thread::id()};  ///< that ticked last, or called first
  client::EmergencyStop emergency_stop;  ///< destroyed first, because it uses the others
};

}  // namespace pacinian
