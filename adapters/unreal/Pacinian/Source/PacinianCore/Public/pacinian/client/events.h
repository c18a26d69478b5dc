#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pacinian/wire/state.h"

namespace pacinian {

/// How a client stands with its server.
enum class Status : std::uint8_t {
  stopped,     ///< not started, or closed
  connecting,  ///< no server yet, or none any more: it is tried again and again
  connected,
  refused,  ///< the server will not have us until something is changed: see `Client::problem`
};

/// What the server, or the client itself, would not do.
struct Refusal {
  std::string code;     ///< as in the wire's table of errors
  std::string message;  ///< for people
  std::string path;     ///< of the field that is wrong, as `$.objects[...].shape`
  std::string advice;   ///< what to do
};

/// Round trips of the last renewals [s]; 0 before the first.
struct Trips {
  double median = 0.0, p99 = 0.0, longest = 0.0;
};

/// Complex sound pressure at each point [Pa]; empty if it was refused or the connection lost.
using FieldCallback = std::function<void(const std::vector<std::complex<float>>&)>;

/// What a game may listen to; all are called by `Client::tick`, on its thread.
struct Events {
  /// A session has begun, the first or a new one: nothing is there, so put the objects, and arm if it is wanted.
  std::function<void()> connected;
  /// The session is over, and with it all objects.
  std::function<void(const std::string& why)> lost;
  /// The sound ended unasked: its code is "expired", "owner", "stopped" or "fault".
  std::function<void(const Refusal&)> ended;
  std::function<void(const Refusal&)> refused;
  /// There is a newer state.
  std::function<void(const wire::State&)> state_changed;
};

}  // namespace pacinian
