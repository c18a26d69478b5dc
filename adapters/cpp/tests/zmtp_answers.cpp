// A socket that executes commands from standard input, one per line, and prints events as lines of JSON.
// Arguments: `Dealer` or `Sub`; address; password ("" for NULL); seconds between heartbeats; their timeout [s]; timeout
// of connecting and of the handshake [s]; `again` to reconnect, or another word. A Sub starts to connect when it gets
// its topic.

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "client_driver.h"
#include "zmtp/zmtp_socket.h"

namespace {

using driver::say;
using namespace pacinian::zmtp;

constexpr std::size_t max_shown = 40;   // [bytes] of a message
constexpr double longest_wait = 1.0;    // [s]
constexpr const char* endings[] = {"None", "Nobody", "Gone", "Denied", "Foreign"};

double read_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string make_pattern(std::size_t count) {
  std::string made(count, '\0');
  for (std::size_t i = 0; i < count; ++i) made[i] = static_cast<char>(i * 7);
  return made;
}

std::string show(const std::vector<std::uint8_t>& bytes) {
  std::string made;
  char digits[3];
  for (std::size_t i = 0; i < std::min(bytes.size(), max_shown); ++i) {
    std::snprintf(digits, sizeof digits, "%02X", bytes[i]);
    made += digits;
  }
  return made;
}

class Driver {
 public:
  Driver(Settings settings, Endpoint at, bool reconnects)
      : settings_(std::move(settings)), at_(at), reconnects_(reconnects) {
    if (settings_.kind == Kind::dealer) open();
  }

  void step() {
    native::Watch watches[] = {{STDIN_FILENO, true, false, false}, {}};
    double wait = longest_wait;
    if (socket_) {
      while (socket_->receive(message_)) tell_message();
      if (socket_->ended() != Ending::none && !std::exchange(is_told_, true))
        say({{"ended", endings[static_cast<int>(socket_->ended())]}, {"problem", socket_->problem()}});
      watches[1] = socket_->watch();
      wait = std::min(wait, socket_->due() - read_clock());
    }
    native::wait(watches, 2, wait);
    if (socket_) socket_->work();
    if (watches[0].is_ready) read_lines();
  }

  bool ends() const { return ends_; }

 private:
  void open() { socket_.emplace(settings_, at_, reconnects_, read_clock); }

  void tell_message() {
    std::int64_t sum = 0;
    for (const std::uint8_t byte : message_) sum = (sum * 31 + byte) % 1'000'003;
    say({{"received", message_.size()}, {"sum", sum}, {"hex", show(message_)}});
  }

  void read_lines() {
    char buffer[4096];
    const ssize_t got = ::read(STDIN_FILENO, buffer, sizeof buffer);
    ends_ = ends_ || got <= 0;
    if (got > 0) waiting_.append(buffer, static_cast<std::size_t>(got));
    for (auto end = waiting_.find('\n'); end != std::string::npos && !ends_; end = waiting_.find('\n')) {
      obey(waiting_.substr(0, end));
      waiting_.erase(0, end + 1);
    }
  }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string what, rest;
    words >> what >> rest;
    bool done = true;
    if (what == "subscribe") settings_.topic = rest, open();
    if (what == "send") done = socket_ && socket_->send(rest);
    if (what == "large") done = socket_ && socket_->send(make_pattern(std::stoul(rest)));
    if (what == "room") done = socket_ && socket_->has_room();
    if (what == "close" || what == "end") socket_.reset();
    ends_ = what == "end";
    say({{"did", what}, {"done", done}});
  }

  Settings settings_;
  const Endpoint at_;
  const bool reconnects_;
  std::optional<ZmtpSocket> socket_;
  std::vector<std::uint8_t> message_;
  std::string waiting_;
  bool ends_ = false, is_told_ = false;
};

}  // namespace

int main(int count, char** arguments) {
  if (count < 8) return 2;
  Settings settings;
  settings.kind = std::string(arguments[1]) == "Sub" ? Kind::sub : Kind::dealer;
  settings.login = {"pacinian", arguments[3]};
  settings.is_plain = !settings.login.password.empty();
  settings.ping_interval = std::atof(arguments[4]);
  settings.ping_timeout = std::atof(arguments[5]);
  settings.connect_timeout = settings.handshake_timeout = std::atof(arguments[6]);
  const auto at = read_endpoint(arguments[2]);
  if (!at) return 2;
  for (Driver driver(settings, *at, std::string(arguments[7]) == "again"); !driver.ends();) driver.step();
  return 0;
}
