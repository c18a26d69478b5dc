#pragma once

#include <string>

namespace pacinian {

/// Why the output is silent for this client. The server determines the cause, except for what only the client knows.
/// For about 30 ms after a command, the newest state may be older than the command, and give a cause that the command
/// has just removed.
struct Silence {
  /// For programs: a value of `cause` on the wire, "not connected" or "not the owner"; empty if it sounds.
  std::string cause;
  std::string text;  ///< for people: the cause and what to do
};

}  // namespace pacinian
