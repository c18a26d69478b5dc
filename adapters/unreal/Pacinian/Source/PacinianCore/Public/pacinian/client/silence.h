#pragma once

#include <string>

namespace pacinian {

/// Why the output is silent for this client. The server finds it, but for what only a client knows. For some 30 ms after
/// a command the newest state may be from before it, and name a cause that the command has just removed.
struct Silence {
  /// For programs: a value of `cause` on the wire, "not connected" or "not the owner"; empty if it sounds.
  std::string cause;
  std::string text;  ///< for people: what is the matter, and what to do
};

}  // namespace pacinian
