#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pacinian::client {

/// The server's three sockets: requests and their answers, commands, the published state.
enum class Channel : std::uint8_t { control, command, state };

inline constexpr std::array channels = {Channel::control, Channel::command, Channel::state};

/// What a connection file holds: where the server is, and the secrets that let us in.
struct ConnectionFile {
  std::int64_t pid = 0;  ///< of the server; 0 for one on another machine
  std::string control, command, state;
  std::string token;  ///< on loopback
  std::string server_key, public_key, secret_key;  ///< CURVE keys (Z85), elsewhere

  const std::string& at(Channel channel) const {
    return channel == Channel::control ? control : channel == Channel::command ? command : state;
  }

  /// Reads the file of a running server, or its content, whose server may be on another machine. False, with the problem and
  /// the fix, if there is none.
  bool read(const std::string& path, std::string& problem);
};

/// Whether that is the content of a connection file, and not its path.
bool is_text(const std::string& path);

/// The connection file: `path`, or as the environment variable PACINIAN_CONNECTION says, or where the
/// server of this user writes it.
std::string where(const std::string& path);

}  // namespace pacinian::client
