#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "reconnect_backoff.h"
#include "connection_file.h"
#include "server_session.h"
#include "mailbox.h"
#include "pacinian/client/options.h"
#include "emergency_stop.h"
#include "transport.h"

namespace pacinian::client {

/// The thread that owns all sockets, from when it is made until it is destroyed.
class Worker final : private MessageSink {
 public:
  /// emergency_stop: while it is busy, resets wait; is told how we connect.
  Worker(const Options& options, EmergencyStop& emergency_stop);
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
  EmergencyStop& emergency_stop_;
  Mailbox mailbox_;
  std::atomic<bool> quits_{false};

  // All below are the thread's own.
  ReconnectBackoff backoff_;
  ServerSession session_;
  ConnectionFile connection_;
  std::unique_ptr<Transport> transport_;  ///< null: not connected
  wire::Bytes message_;
  double held_ = never;  ///< when the state in `incoming_` came
  Outbox* outbox_;
  std::vector<Request> requests_;
  SessionStatus status_;
  wire::AnyState incoming_;
  std::uint64_t sessions_ = 0;
  std::thread thread_;
};

}  // namespace pacinian::client
