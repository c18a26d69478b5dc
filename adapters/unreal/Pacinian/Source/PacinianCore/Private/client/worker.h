#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "attempts.h"
#include "connection.h"
#include "dialogue.h"
#include "mailbox.h"
#include "pacinian/client/options.h"
#include "stopper.h"
#include "transport.h"

namespace pacinian::client {

/// The thread that owns all sockets, from when it is made until it is destroyed.
class Worker final : private Outlet {
 public:
  /// stopper: while it is busy, resets wait; is told how we connect.
  Worker(const Options& options, Stopper& stopper);
  ~Worker();

  Mailbox& mailbox() { return mailbox_; }

 private:
  bool control(const wire::Writer& message) override;
  bool command(const wire::Writer& message) override;

  static constexpr double never = std::numeric_limits<double>::infinity();

  static wire::Hello introduce(const Options& options);
  void run();
  void connect(double now);
  void disconnect();
  void speak(double now);
  void hear();
  void look();
  void notice();
  void tell(double now);
  void show();
  void wait(double now);
  void leave();

  const Options options_;
  Stopper& stopper_;
  Mailbox mailbox_;
  std::atomic<bool> quits_{false};

  // All below are the thread's own.
  Attempts attempts_;
  Dialogue dialogue_;
  Connection connection_;
  std::unique_ptr<Transport> transport_;  ///< null: not connected
  wire::Bytes message_;
  double held_ = never;  ///< when the state in `incoming_` came
  Outbox* outbox_;
  std::vector<Request> requests_;
  View view_;
  wire::AnyState incoming_;
  std::uint64_t sessions_ = 0;
  std::thread thread_;
};

}  // namespace pacinian::client
