#pragma once

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "endpoint.h"
#include "tcp_link.h"
#include "zmtp_connection.h"

namespace pacinian::zmtp {

/// A DEALER or SUB socket that connects to one peer. Belongs to one thread and never blocks. Call `work` when an event
/// of `watch` occurs, and when it is `due`.
class ZmtpSocket {
 public:
  using Clock = double (*)();  // [s]

  /// Starts to connect. reconnects: whether it connects again after each end.
  ZmtpSocket(Settings settings, const Endpoint& at, bool reconnects, Clock clock);

  /// Returns how the connection has ended; `none` if the socket reconnects.
  Ending ended() const { return reconnects_ ? Ending::none : current(); }

  /// Returns why the connection has ended, for people; "" if the peer closed it.
  std::string problem() const { return connection_ ? connection_->problem() : ""; }

  /// Returns whether a message can be sent now.
  bool has_room() const { return connection_ && connection_->has_room(); }

  /// Connects, shakes hands, and sends waiting messages and heartbeats, as far as they are due.
  void work();

  /// Takes a message. Returns false if there is no room.
  bool send(std::string_view body);

  /// Receives the last part of the next message. Returns false if there is none.
  bool receive(std::vector<std::uint8_t>& into);

  /// Returns the events to wait for.
  native::Watch watch() const;

  /// Returns when `work` must be called at the latest, by the clock.
  double due() const;

 private:
  static constexpr double never = std::numeric_limits<double>::infinity();

  Ending current() const { return connection_ ? connection_->ending() : unconnected_; }
  bool is_over() const { return !link_ || current() != Ending::none; }
  void connect(double now);
  bool read_bytes(double now);
  void go_on(double now);
  void end(Ending ending, double now);

  const Settings settings_;
  const Endpoint at_;
  const bool reconnects_;
  const Clock clock_;
  std::unique_ptr<TcpLink> link_;
  std::unique_ptr<ZmtpConnection> connection_;
  double begun_ = 0.0, pause_, next_attempt_ = -never;
  Ending unconnected_ = Ending::none;
};

}  // namespace pacinian::zmtp
