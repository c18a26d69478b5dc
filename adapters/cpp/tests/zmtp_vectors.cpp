// Runs every case of ZMTP's byte vectors, with all bytes at once and byte by byte.

#include <algorithm>
#include <deque>
#include <optional>

#include "zmtp/zmtp_connection.h"
#include "zmtp_feed.h"
#include "zmtp_script.h"

namespace {

using pacinian::zmtp::Ending;
using pacinian::zmtp::Kind;
using pacinian::zmtp::Settings;
using pacinian::zmtp::ZmtpConnection;

constexpr const char* endings[] = {"none", "nobody", "gone", "denied", "foreign"};

Settings read_settings(const script::Step& step) {
  Settings made;
  made.kind = step.what == "sub" ? Kind::sub : Kind::dealer;
  for (const std::string& word : script::split(step.rest)) {
    const std::size_t is = std::min(word.find('='), word.size());
    const std::string key = word.substr(0, is), value = word.substr(std::min(is + 1, word.size()));
    if (key == "user") made.is_plain = true, made.login.user = value;
    if (key == "password") made.login.password = value;
    if (key == "topic") made.topic = value;
    if (key == "ping") made.ping_interval = std::stod(value), made.ping_timeout = 1.5;
  }
  return made;
}

/// Runs the steps of a case on a connection.
class Runner {
 public:
  explicit Runner(std::size_t at_once) : at_once_(at_once) {}

  /// Returns "" if the step succeeds.
  std::string run(const script::Step& step) {
    if (step.what == "dealer" || step.what == "sub") {
      settings_ = read_settings(step);
      made_.emplace(settings_, now_);
    } else if (step.what == "gives") {
      feed::give(*made_, step.rest, now_, at_once_, messages_);
    } else if (step.what == "says") {
      const std::string said = feed::take(*made_);
      if (said != step.rest) return "said " + show(said);
    } else if (step.what == "sends") {
      if (!made_->send(step.rest)) return "takes no message";
    } else if (step.what == "reads") {
      if (messages_.empty()) return "no message";
      const std::string message = std::exchange(messages_.front(), {});
      messages_.pop_front();
      if (message != step.rest) return "read " + show(message);
    } else if (step.what == "time") {
      now_ = std::stod(step.rest);
      made_->check_time(now_);
    } else if (step.what == "open" || step.what == "ready") {
      if (made_->ending() != Ending::none) return "ended: " + made_->problem();
      if (made_->is_established() != (step.what == "ready")) return "no";
    } else if (step.what == "ends") {
      return check_end(step.rest);
    } else {
      return "is no step";
    }
    return "";
  }

  /// Returns "" if no message is left over.
  std::string finish() const { return messages_.empty() ? "" : "a message was not expected"; }

 private:
  std::string check_end(const std::string& wanted) const {
    const std::size_t space = std::min(wanted.find(' '), wanted.size());
    const std::string how = endings[static_cast<int>(made_->ending())];
    const bool is_right = how == wanted.substr(0, space) && !made_->has_room() &&
                          made_->problem().find(wanted.substr(space + 1)) != std::string::npos;
    return is_right ? "" : "ended " + how + " " + made_->problem();
  }

  static std::string show(const std::string& bytes) {
    std::string made;
    char digits[4];
    for (const char byte : bytes) {
      std::snprintf(digits, sizeof digits, "%02x ", static_cast<unsigned char>(byte));
      made += digits;
    }
    return made;
  }

  const std::size_t at_once_;
  Settings settings_;
  std::optional<ZmtpConnection> made_;
  std::deque<std::string> messages_;
  double now_ = 0.0;
};

}  // namespace

int main(int count, char** arguments) {
  int passed = 0, failed = 0;
  for (const script::Case& each : script::read(std::string(count > 1 ? arguments[1] : "tests/wire") + "/zmtp.txt")) {
    for (const std::size_t at_once : {std::size_t{1}, SIZE_MAX}) {
      Runner runner(at_once);
      std::string problem;
      int line = 0;
      for (const script::Step& step : each.steps) {
        problem = runner.run(step);
        line = step.line;
        if (!problem.empty()) break;
      }
      if (problem.empty()) problem = runner.finish();
      ++(problem.empty() ? passed : failed);
      if (!problem.empty()) std::printf("line %d: %s: %s\n", line, each.name.c_str(), problem.c_str());
    }
  }
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 && passed > 0 ? 0 : 1;
}
