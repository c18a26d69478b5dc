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

/// The thread that owns all sockets. It runs from construction to destruction.
class Worker final : private MessageSink {
 public:
  /// emergency_stop: resets wait while it is busy; it receives the connection.
  Worker(const Options& options, EmergencyStop& emergency_stop);
  ~Worker();

  Mailbox& mailbox() { return mailbox_; }

 private:
  bool send_control(const wire::Writer& message) override;
  bool send_command(const wire::Writer& message) override;

  static constexpr double never = std::numeric_limits<double>::infinity();

  static wire::Hello make_hello(const Options& options);
  void run();
  void connect(double now);
  void disconnect();
  void send_messages(double now);
  void receive_messages();
  void receive_state();
  void check_connection();
  void report_events(double now);
  void publish_status();
  void wait_for_work(double now);
  void say_goodbye();

  const Options options_;
  EmergencyStop& emergency_stop_;
  Mailbox mailbox_;
  std::atomic<bool> quits_{false};

  // Only the thread uses the members below.
  ReconnectBackoff backoff_;
  ServerSession session_;
  ConnectionFile connection_;
  std::unique_ptr<Transport> transport_;  ///< null: not connected
  wire::Bytes message_;
  double held_ = never;  ///< when the state in `incoming_` arrived
  Outbox* outbox_;
  std::vector<Request> requests_;
  SessionStatus status_;
  wire::AnyState incoming_;
  std::uint64_t sessions_ = 0;
  std::thread thread_;
};

}  // namespace pacinian::client
