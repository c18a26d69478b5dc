#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pacinian::zmtp {

/// The kinds of sockets that the client has.
enum class Kind : std::uint8_t { dealer, sub };

/// The name and password of PLAIN.
struct Login {
  static constexpr std::size_t max_size = 255;  ///< [bytes] that a HELLO has room for

  std::string user, password;
};

constexpr double default_timeout = 2.0;  ///< [s] for TCP to connect, and for the handshake after that

/// The settings of a socket.
struct Settings {
  Kind kind = Kind::dealer;
  bool is_plain = false;  ///< otherwise NULL, without a login
  Login login;
  std::string topic;                  ///< prefix of the messages that a subscriber wants
  std::size_t max_message = 1 << 20;  ///< [bytes] of a part of a message
  double connect_timeout = default_timeout;    ///< [s] for TCP to connect
  double handshake_timeout = default_timeout;  ///< [s] for the handshake after that
  double ping_interval = 0.0;         ///< [s] between two heartbeats; 0: none are sent, but the peer's are answered
  double ping_timeout = 0.0;          ///< [s] longest silence of a peer after a heartbeat; needed if any are sent
  std::size_t max_frames = 16;        ///< waiting frames beyond which messages are not accepted

  /// Returns whether a message that begins with this part is wanted.
  bool wants(std::string_view part) const { return kind != Kind::sub || part.substr(0, topic.size()) == topic; }
};

}  // namespace pacinian::zmtp
