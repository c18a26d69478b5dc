#pragma once

#include <algorithm>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

#include "zmtp/zmtp_connection.h"

/// Replaces TCP between a connection and a test.
namespace feed {

using pacinian::zmtp::ZmtpConnection;

/// Reads all messages that have arrived.
inline void read_all(ZmtpConnection& from, std::deque<std::string>& messages) {
  std::vector<std::uint8_t> message;
  while (from.read(message)) messages.emplace_back(message.begin(), message.end());
}

/// Gives some bytes. Returns how many there was room for.
inline std::size_t give_some(ZmtpConnection& to, const char* bytes, std::size_t count, double now) {
  const auto room = to.input().reserve();
  count = std::min(count, room.size);
  if (count > 0) std::memcpy(room.data, bytes, count);
  to.input().add(count);
  to.note_arrival(now);
  return count;
}

/// Gives bytes, at most `at_once` at a time, until the connection ends, and reads the messages.
inline void give(ZmtpConnection& to, const std::string& bytes, double now, std::size_t at_once,
                 std::deque<std::string>& messages) {
  for (std::size_t at = 0; at < bytes.size() && to.ending() == pacinian::zmtp::Ending::none;) {
    at += give_some(to, bytes.data() + at, std::min(at_once, bytes.size() - at), now);
    read_all(to, messages);
  }
}

/// Takes the bytes to be sent.
inline std::string take(ZmtpConnection& from) {
  const std::string found(reinterpret_cast<const char*>(from.output().data()), from.output().size());
  from.output().mark_sent(found.size());
  return found;
}

}  // namespace feed
