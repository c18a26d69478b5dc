// Tests of a connection's limits (memory, waiting messages, heartbeats), of its end, and of addresses.

#include "expect.h"
#include "zmtp/endpoint.h"
#include "zmtp_feed.h"

namespace {

using pacinian::zmtp::Ending;
using pacinian::zmtp::read_endpoint;
using pacinian::zmtp::Settings;
using pacinian::zmtp::ZmtpConnection;

constexpr std::size_t max_message = 1 << 20;

const Settings& settings() {
  static const Settings made;
  return made;
}

std::string make_greeting() {
  std::string made(64, '\0');
  made[0] = '\xff';
  made[9] = '\x7f';
  made[10] = 3;
  made[11] = 1;
  return made.replace(12, 4, "NULL");
}

/// A connection that is ready, and has nothing to send.
struct Ready : ZmtpConnection {
  Ready() : ZmtpConnection(settings(), 0.0) {
    give(make_greeting() + std::string("\4\x1c\5READY\x0bSocket-Type\0\0\0\6ROUTER", 30));
    feed::take(*this);
    EXPECT(is_established());
  }
  void give(const std::string& bytes) { feed::give(*this, bytes, 0.0, SIZE_MAX, messages); }
  std::deque<std::string> messages;
};

std::string make_head(std::uint64_t size) {
  std::string made(1, '\2');
  for (int shift = 56; shift >= 0; shift -= 8) made += static_cast<char>(size >> shift & 0xff);
  return made;
}

void what_is_announced_takes_no_memory() {
  for (const std::uint64_t size : {max_message + 1, std::size_t{0x7fffffff}, SIZE_MAX / 2, SIZE_MAX}) {
    Ready made;
    const std::size_t before = made.input().capacity();
    made.give(make_head(size));
    EXPECT(made.ending() == Ending::foreign && made.input().capacity() == before);
  }
  Ready made;
  const std::size_t before = made.input().capacity();
  made.give(make_head(max_message) + std::string(2000, '\0'));
  EXPECT(made.ending() == Ending::none && made.input().capacity() == before);
  made.give(std::string(max_message - 2000, '\0'));
  EXPECT(made.messages.size() == 1 && made.messages[0].size() == max_message);
  EXPECT(made.input().capacity() == max_message + 9);
}

void memory_grows_with_what_came() {
  Ready made;
  made.give(make_head(max_message));
  std::size_t came = 9;
  for (int i = 0; i < 200; ++i, came += 5000) {
    made.give(std::string(5000, 'x'));
    EXPECT(made.input().capacity() <= std::max<std::size_t>(8192, 2 * (came + 5000)));
  }
}

void messages_are_taken_up_to_a_limit() {
  Ready made;
  for (std::size_t i = 0; i < settings().max_frames; ++i) EXPECT(made.has_room() && made.send("0123456789"));
  EXPECT(!made.has_room() && !made.send("0123456789"));
  made.output().mark_sent(8 * 12 - 1);  // each has a head of two bytes
  EXPECT(!made.has_room() && made.output().frames() == 9);
  made.output().mark_sent(1);
  for (int i = 0; i < 8; ++i) EXPECT(made.has_room() && made.send("0123456789"));
  EXPECT(!made.has_room() && made.output().size() == 16 * 12);
}

void a_flood_of_heartbeats_is_answered_up_to_a_limit() {
  Ready made;
  for (int i = 0; i < 10'000; ++i) made.give(std::string("\4\7\4PING\0\0", 9));
  EXPECT(made.output().frames() == 64 && made.ending() == Ending::none);
}

void how_a_connection_is_closed() {
  ZmtpConnection stranger(settings(), 0.0);
  stranger.note_closed();
  EXPECT(stranger.ending() == Ending::foreign);
  Ready made;
  feed::give_some(made, "\0\1a", 3, 0.0);
  made.note_closed();
  EXPECT(made.ending() == Ending::gone && !made.has_room());
  feed::read_all(made, made.messages);
  EXPECT(made.messages.size() == 1 && made.messages[0] == "a");  // received messages are still read
}

void after_an_error_nothing_is_read() {
  Ready made;
  feed::give_some(made, "\0\1a\4\x0b\5ERROR\4over\0\1b", 19, 0.0);
  made.note_closed();
  feed::read_all(made, made.messages);
  EXPECT(made.messages.size() == 1 && made.messages[0] == "a");
}

void what_a_peer_says_is_printable() {
  Ready made;
  made.give(std::string("\4\xa\5ERROR\3\n\x1b\xff", 12));
  EXPECT(made.ending() == Ending::gone && made.problem() == "the peer closes the connection: ???");
}

void addresses() {
  const auto found = read_endpoint("tcp://127.0.0.1:5555");
  EXPECT(found && !found->is_v6 && found->port == 5555 && found->address[0] == 127 && found->address[3] == 1);
  const auto local = read_endpoint("tcp://localhost:1");
  EXPECT(local && local->address == found->address && local->port == 1);
  const auto v6 = read_endpoint("tcp://[::1]:5555");
  EXPECT(v6 && v6->is_v6 && v6->address[0] == 0 && v6->address[15] == 1);
  EXPECT(found->is_loopback() && v6->is_loopback());
  for (const char* far : {"tcp://192.0.2.1:5", "tcp://128.0.0.1:5", "tcp://[::2]:5", "tcp://[::ffff:127.0.0.1]:5"})
    EXPECT(read_endpoint(far) && !read_endpoint(far)->is_loopback());
  for (const char* wrong :
       {"", "nowhere", "tcp://", "tcp://:1", "tcp://127.0.0.1", "tcp://127.0.0.1:", "tcp://127.0.0.1:0",
        "tcp://127.0.0.1:65536", "tcp://127.0.0.1:-1", "tcp://127.0.0.1: 1", "tcp://127.0.0.1:+1", "tcp://::1:5",
        "tcp://[127.0.0.1]:5", "tcp://[::1:5", "tcp://[localhost]:5", "tcp://[]:5", "ipc:///tmp/a:1",
        "tcp://a.example:5", "tcp://127.0.0.1:99999999999", "tcp://1.2.3:5"})
    EXPECT(!read_endpoint(wrong));
}

}  // namespace

int main() {
  what_is_announced_takes_no_memory();
  memory_grows_with_what_came();
  messages_are_taken_up_to_a_limit();
  a_flood_of_heartbeats_is_answered_up_to_a_limit();
  how_a_connection_is_closed();
  after_an_error_nothing_is_read();
  what_a_peer_says_is_printable();
  addresses();
  return check::result();
}
