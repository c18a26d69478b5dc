#include "zmtp_connection.h"

#include <algorithm>
#include <cmath>

#include "command.h"

namespace pacinian::zmtp {

namespace {

constexpr std::size_t max_waiting_frames = 64;  // beyond which heartbeats are not answered
constexpr std::size_t ttl_bytes = 2, max_context_bytes = 16;  // of a heartbeat
constexpr double ttl_unit = 0.1;                              // [s]

std::string write_ttl(double seconds) {
  const int units = static_cast<int>(std::lround(seconds / ttl_unit));
  return {static_cast<char>(units >> 8), static_cast<char>(units)};
}

double read_ttl(std::string_view data) {
  return ttl_unit * (static_cast<std::uint8_t>(data[0]) << 8 | static_cast<std::uint8_t>(data[1]));
}

}  // namespace

ZmtpConnection::ZmtpConnection(const Settings& settings, double now)
    : settings_(settings),
      handshake_(settings),
      input_(settings.max_message, command::max_size),
      ping_(write_ttl(settings.ping_timeout)),
      begun_(now),
      heard_(now),
      pinged_(now) {
  handshake_.begin(output_);
}

void ZmtpConnection::note_arrival(double now) {
  heard_ = now;
  unanswered_ = peer_deadline_ = never;
}

/// Reads a frame. Any frame after a heartbeat ends that heartbeat's time to live, even if both arrived together.
bool ZmtpConnection::read_frame() {
  if (!is_established_ || is_cut_off_ || !input_.read()) return false;
  peer_deadline_ = never;
  return true;
}

void ZmtpConnection::advance() {
  if (is_established_ || ending_ != Ending::none) return;
  while (handshake_.advance(input_, output_)) {
  }
  if (!handshake_.problem().empty())
    return end(handshake_.is_denied() ? Ending::denied : Ending::foreign, handshake_.problem());
  is_established_ = handshake_.is_done();
  if (is_established_ && settings_.kind == Kind::sub) subscribe();
}

/// Uses a command (RFC 37, "The Publish-Subscribe Pattern"), or for a peer of ZMTP 3.0 a message (RFC 23, the same).
void ZmtpConnection::subscribe() {
  if (handshake_.minor() >= 1)
    output_.write_command(command::subscribe, settings_.topic);
  else
    output_.write_message('\1' + settings_.topic);
}

bool ZmtpConnection::read(std::vector<std::uint8_t>& into) {
  advance();
  while (read_frame()) {
    if (input_.is_command()) {
      handle_command();
      continue;
    }
    const std::string_view part = input_.body();
    if (!is_in_message_) is_wanted_ = settings_.wants(part);
    is_in_message_ = input_.has_more();
    if (is_in_message_ || !is_wanted_) continue;
    into.assign(part.begin(), part.end());
    return true;
  }
  if (!input_.problem().empty()) end(Ending::foreign, input_.problem());
  return false;
}

bool ZmtpConnection::send(std::string_view body) {
  if (!has_room()) return false;
  output_.write_message(body);
  is_full_ = output_.frames() >= settings_.max_frames;
  return true;
}

void ZmtpConnection::check_time(double now) {
  if (!is_established_) {
    if (now - begun_ > settings_.handshake_timeout) end(Ending::foreign, "the handshake takes too long");
    return;
  }
  if (sends_pings() && now - pinged_ >= settings_.ping_interval) {
    pinged_ = now;
    unanswered_ = std::min(unanswered_, now);
    if (output_.size() == 0) output_.write_command(command::ping, ping_);  // otherwise heartbeats would pile up
  }
  if (now - unanswered_ > settings_.ping_timeout || now > peer_deadline_)
    end(Ending::gone, "the peer is silent");
}

double ZmtpConnection::due() const {
  if (!is_established_) return begun_ + settings_.handshake_timeout;
  const double ping = sends_pings() ? pinged_ + settings_.ping_interval : never;
  return std::min({ping, unanswered_ + settings_.ping_timeout, peer_deadline_});
}

void ZmtpConnection::handle_command() {
  if (const command::Data ping = command::match(input_, command::ping)) answer_ping(*ping);
  if (const command::Data error = command::match(input_, command::error))
    cut_off(Ending::gone, "the peer closes the connection: " + command::make_printable(command::read_text(*error).value_or("")));
}

void ZmtpConnection::cut_off(Ending ending, std::string problem) {
  is_cut_off_ = true;
  end(ending, std::move(problem));
}

void ZmtpConnection::answer_ping(std::string_view data) {
  if (data.size() < ttl_bytes || data.size() > ttl_bytes + max_context_bytes)
    return cut_off(Ending::foreign,
                   "the peer sent a heartbeat of " + std::to_string(data.size()) + " bytes, not " +
                       std::to_string(ttl_bytes) + " to " + std::to_string(ttl_bytes + max_context_bytes));
  const double ttl = read_ttl(data);
  peer_deadline_ = ttl > 0.0 ? heard_ + ttl : never;
  if (output_.frames() < max_waiting_frames) output_.write_command(command::pong, data.substr(ttl_bytes));
}

void ZmtpConnection::end(Ending ending, std::string problem) {
  if (ending_ != Ending::none) return;
  ending_ = ending;
  problem_ = std::move(problem);
}

}  // namespace pacinian::zmtp
