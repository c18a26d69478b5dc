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

/// A DEALER or SUB socket with one peer, to which it connects. It belongs to one thread and never waits: `work` is to be
/// called when what `watch` says has come, and when it is `due`.
class ZmtpSocket {
 public:
  using Clock = double (*)();  // [s]

  /// Begins to connect. reconnects: again and again; else its end is its end.
  ZmtpSocket(Settings settings, const Endpoint& at, bool reconnects, Clock clock);

  /// How it has ended; never if it reconnects.
  Ending ended() const { return reconnects_ ? Ending::none : current(); }

  /// Why it has ended, for people; "" if the peer has just closed it.
  std::string problem() const { return connection_ ? connection_->problem() : ""; }

  /// Whether a message can be sent now.
  bool has_room() const { return connection_ && connection_->has_room(); }

  /// Does what is due: connects, shakes hands, sends what waits, and heartbeats.
  void work();

  /// Takes a message; false if there is no room for it.
  bool send(std::string_view body);

  /// The last part of the next message; false if there is none.
  bool receive(std::vector<std::uint8_t>& into);

  /// What is to be waited for.
  native::Watch watch() const;

  /// When `work` is to be called at the latest, by the clock.
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
