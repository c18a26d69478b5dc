#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pacinian::client {

/// The server's three sockets: requests and replies, commands, and the published state.
enum class Channel : std::uint8_t { control, command, state };

inline constexpr std::array channels = {Channel::control, Channel::command, Channel::state};

/// The content of a connection file: where the server is, and the secrets for authentication.
struct ConnectionFile {
  std::int64_t pid = 0;  ///< of the server; 0 for one on another machine
  std::string control, command, state;
  std::string stop;   ///< where a server on this machine receives an emergency stop without a connection
  std::string token;  ///< for a server on this machine
  std::string server_key, public_key, secret_key;  ///< CURVE keys (Z85), for a server on another machine

  const std::string& at(Channel channel) const {
    return channel == Channel::control ? control : channel == Channel::command ? command : state;
  }

  /// Reads the file of a running server, or the content of such a file, whose server may be on another machine. Returns
  /// false, the problem and the fix on failure.
  bool read(const std::string& path, std::string& problem);
};

/// Returns whether a string is the content of a connection file instead of a path.
bool is_text(const std::string& path);

/// Returns `path` unless it is empty, otherwise the path in the environment variable PACINIAN_CONNECTION, otherwise the
/// place where this user's server writes the file.
std::string where(const std::string& path);

}  // namespace pacinian::client
