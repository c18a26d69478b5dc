#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pacinian::zmtp {

/// The kinds of sockets that this client has.
enum class Kind : std::uint8_t { dealer, sub };

/// The name and password of PLAIN.
struct Login {
  static constexpr std::size_t max_size = 255;  ///< [bytes] of each: what a HELLO has room for

  std::string user, password;
};

/// How a socket speaks with its peer.
struct Settings {
  Kind kind = Kind::dealer;
  bool is_plain = false;  ///< else NULL, without a login
  Login login;
  std::string topic;                  ///< how messages begin that a subscriber wants
  std::size_t max_message = 1 << 20;  ///< [bytes] of a part of a message
  double connect_timeout = 2.0;       ///< [s] within which TCP must connect
  double handshake_timeout = 2.0;     ///< [s] within which the peer must then have shaken hands
  double ping_interval = 0.0;         ///< [s] between two heartbeats; 0: none are sent, but the peer's are answered
  double ping_timeout = 1.5;          ///< [s] that a peer may be silent after a heartbeat, here and there
  std::size_t max_frames = 16;        ///< that wait to be sent before no more messages are taken

  /// Whether a message that begins with this part is wanted.
  bool wants(std::string_view part) const { return kind != Kind::sub || part.substr(0, topic.size()) == topic; }
};

}  // namespace pacinian::zmtp
