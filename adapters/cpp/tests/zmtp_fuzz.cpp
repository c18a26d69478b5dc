// Feeds tampered or random bytes of a peer in parts of any size, under sanitizers: no invalid address, bounded memory,
// and an end.
// Arguments: seed, number of conversations.

#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include "zmtp/command.h"
#include "zmtp/frame_writer.h"
#include "zmtp_feed.h"

namespace {

using namespace pacinian::zmtp;

constexpr std::size_t max_message = 20'000, first_capacity = 8192, max_output = 100'000;  // [bytes]

void require(bool good, const char* what) {
  if (good) return;
  std::printf("%s\n", what);
  std::abort();
}

class Fuzz {
 public:
  explicit Fuzz(unsigned seed) : random_(seed) {}

  /// Runs a conversation. Returns how it ended.
  std::string converse() {
    Settings settings;
    settings.kind = choose(2) ? Kind::dealer : Kind::sub;
    settings.is_plain = choose(2) == 0;
    settings.login = {"pacinian", "token"};
    settings.topic = "state";
    settings.max_message = max_message;
    settings.ping_interval = 0.05 * static_cast<double>(choose(2));
    settings.ping_timeout = 1.5;
    const std::string bytes = tamper(make_transcript(settings));
    ZmtpConnection made(settings, 0.0);
    std::deque<std::string> messages;
    feed_all(made, bytes, messages);
    made.note_closed();
    feed::read_all(made, messages);
    require(made.ending() != Ending::none && !made.has_room(), "it goes on after its end");
    const std::string how = made.ending() == Ending::gone      ? "gone"
                            : made.ending() == Ending::denied ? "denied"
                                                              : "foreign";
    return how + (!messages.empty()           ? " after messages"
                  : made.is_established() ? " after the handshake"
                                          : " in the handshake");
  }

 private:
  std::size_t choose(std::size_t below) { return random_() % below; }

  void feed_all(ZmtpConnection& made, const std::string& bytes, std::deque<std::string>& messages) {
    double now = 0.0;
    const std::size_t largest = choose(3) == 0 ? 1 : 1 + choose(5000);
    for (std::size_t at = 0; at < bytes.size() && made.ending() == Ending::none;) {
      now += 0.001;
      at += feed::give_some(made, bytes.data() + at, std::min(1 + choose(largest), bytes.size() - at), now);
      feed::read_all(made, messages);
      require(messages.empty() || messages.back().size() <= max_message, "a message is too large");
      require(messages.size() <= bytes.size() / 2, "there are more messages than can be");
      made.check_time(now);
      made.send(std::string(choose(100), 'x'));
      if (choose(2)) made.output().mark_sent(choose(made.output().size() + 1));
      const std::size_t fits = std::max(first_capacity, std::min(max_message + 9, 2 * at));
      require(made.input().capacity() <= fits, "what comes takes too much memory");
      require(made.output().size() <= max_output, "what is to be sent takes too much memory");
    }
  }

  /// Returns what a well-behaved server sends.
  std::string make_transcript(const Settings& settings) {
    FrameWriter said;
    std::string greeting(64, '\0');
    greeting[0] = '\xff';
    greeting[9] = '\x7f';
    greeting[10] = 3;
    greeting[11] = static_cast<char>(choose(2));
    const std::string mechanism = settings.is_plain ? "PLAIN" : "NULL";
    said.write_raw(greeting.replace(12, mechanism.size(), mechanism));
    if (settings.is_plain) said.write_command(command::welcome, "");
    const char* type = settings.kind == Kind::sub ? "PUB" : "ROUTER";
    said.write_command(command::ready, command::write_properties(
                                           {{"Socket-Type", type}, {"Identity", ""}, {"X-Else", "anything"}}));
    const std::string body = "state" + std::string(max_message - 5, '\0');
    for (std::size_t i = choose(20); i > 0; --i) {
      const std::string_view all = body;
      switch (choose(4)) {
        case 0: said.write_command(command::ping, std::string("\0\xc8\1\2\3", 5).substr(0, 2 + choose(4))); break;
        case 1: said.write_command(command::pong, all.substr(0, choose(17))); break;
        case 2: said.write_message(all.substr(0, choose(300))); break;
        default: said.write_message(all.substr(0, choose(max_message + 1))); break;
      }
    }
    return {reinterpret_cast<const char*>(said.data()), said.size()};
  }

  std::string tamper(std::string bytes) {
    if (choose(20) == 0) return make_noise(choose(3000));
    for (std::size_t i = choose(4); i > 0 && !bytes.empty(); --i) {
      const std::size_t head = std::min<std::size_t>(200, bytes.size());
      const std::size_t at = choose(choose(2) ? head : bytes.size());
      switch (choose(6)) {
        case 0: bytes[at] = static_cast<char>(choose(256)); break;
        case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << choose(8))); break;
        case 2: bytes.resize(at); break;
        case 3: bytes.erase(at, 1); break;
        case 4: bytes.insert(at, make_noise(1 + choose(39))); break;
        default: bytes.insert(at, make_announcement()); break;
      }
    }
    return bytes;
  }

  std::string make_noise(std::size_t count) {
    std::string made(count, '\0');
    for (char& byte : made) byte = static_cast<char>(choose(256));
    return made;
  }

  /// Returns the head of a large frame.
  std::string make_announcement() {
    std::string made = make_noise(9);
    made[0] = static_cast<char>(2 + 4 * choose(2) + choose(2));
    const std::size_t zeros = 8 - choose(8);
    for (std::size_t i = 1; i < zeros; ++i) made[i] = 0;
    return made;
  }

  std::mt19937 random_;
};

}  // namespace

int main(int count, char** arguments) {
  Fuzz fuzz(static_cast<unsigned>(count > 2 ? std::atoi(arguments[1]) : 0));
  const int conversations = count > 2 ? std::atoi(arguments[2]) : 1000;
  std::map<std::string, int> ends;
  for (int i = 0; i < conversations; ++i) ++ends[fuzz.converse()];
  for (const auto& [how, often] : ends) std::printf("%d %s\n", often, how.c_str());
  std::printf("%d conversations\n", conversations);
  return 0;
}
