#include "zmtp_socket.h"

#include <algorithm>

namespace pacinian::zmtp {

namespace {

constexpr double first_pause = 0.1, longest_pause = 2.0;  // [s] before it connects again
constexpr int max_rounds = 16;                            // for one message, of a peer that sends without end

}  // namespace

ZmtpSocket::ZmtpSocket(Settings settings, const Endpoint& at, bool reconnects, Clock clock)
    : settings_(std::move(settings)), at_(at), reconnects_(reconnects), clock_(clock), pause_(first_pause) {
  work();
}

void ZmtpSocket::work() {
  const double now = clock_();
  if (!link_ && now >= next_attempt_) connect(now);
  if (is_over()) return;
  if (!connection_) {
    link_->try_connect();
    const bool is_late = now - begun_ > settings_.connect_timeout;
    if (link_->is_closed() || (is_late && !link_->is_connected())) return end(Ending::nobody, now);
    if (!link_->is_connected()) return;
    connection_ = std::make_unique<ZmtpConnection>(settings_, now);
  }
  read_bytes(now);
  go_on(now);
}

bool ZmtpSocket::send(std::string_view body) {
  if (!connection_ || !connection_->send(body)) return false;
  link_->write(connection_->output());
  return true;
}

bool ZmtpSocket::receive(std::vector<std::uint8_t>& into) {
  for (int i = 0; i < max_rounds && connection_; ++i) {
    if (connection_->read(into)) return true;
    if (is_over()) return false;
    const double now = clock_();
    const bool has_some = read_bytes(now);
    if (connection_->read(into)) return true;
    go_on(now);
    if (!has_some) return false;
  }
  return false;
}

native::Watch ZmtpSocket::watch() const {
  if (is_over()) return {};
  return link_->watch(connection_ && connection_->output().size() > 0);
}

double ZmtpSocket::due() const {
  if (is_over()) return reconnects_ ? next_attempt_ : never;
  if (!connection_) return begun_ + settings_.connect_timeout;
  // Bytes already read from TCP do not end a wait.
  const bool has_unread = connection_->is_established() && connection_->input().is_unread();
  return has_unread ? -never : connection_->due();
}

void ZmtpSocket::connect(double now) {
  connection_.reset();
  unconnected_ = Ending::none;
  begun_ = now;
  link_ = std::make_unique<TcpLink>(at_);
}

bool ZmtpSocket::read_bytes(double now) {
  const bool has_some = link_->read(connection_->input());
  if (has_some) connection_->note_arrival(now);
  return has_some;
}

/// now: the time before the last bytes were read.
void ZmtpSocket::go_on(double now) {
  connection_->advance();
  connection_->check_time(now);
  link_->write(connection_->output());
  if (link_->is_closed()) connection_->note_closed();
  if (connection_->is_established()) pause_ = first_pause;
  if (connection_->ending() != Ending::none) end(connection_->ending(), now);
}

void ZmtpSocket::end(Ending ending, double now) {
  unconnected_ = ending;
  if (!reconnects_) return;
  link_.reset();
  next_attempt_ = now + pause_;
  pause_ = std::min(2.0 * pause_, longest_pause);
}

}  // namespace pacinian::zmtp
