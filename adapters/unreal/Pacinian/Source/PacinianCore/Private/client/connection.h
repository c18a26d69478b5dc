#pragma once

#include <cstdint>
#include <string>

namespace pacinian::client {

/// What a connection file holds: where the server is, and the secrets that let us in.
struct Connection {
  std::int64_t pid = 0;  ///< of the server; 0 for one on another machine
  std::string control, command, state;
  std::string token;  ///< on loopback
  std::string server_key, public_key, secret_key;  ///< CURVE keys (Z85), elsewhere

  /// Reads the file of a running server. False, with the problem and the fix, if there is none.
  bool read(const std::string& path, std::string& problem);
};

/// The connection file: `path`, or as the environment variable PACINIAN_CONNECTION says, or where the
/// server of this user writes it.
std::string where(const std::string& path);

}  // namespace pacinian::client
