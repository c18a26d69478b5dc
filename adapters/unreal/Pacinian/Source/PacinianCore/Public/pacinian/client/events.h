#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pacinian/api.h"
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

  PACINIANCORE_API std::string text() const;  ///< in one line, for people, without what is empty
};

/// Round trips of the last renewals [s]; 0 before the first.
struct Trips {
  double median = 0.0, p99 = 0.0, longest = 0.0;
};

/// The game did not tick for longer than its lease while it was armed, and goes on now.
struct Standstill {
  double seconds = 0.0;  ///< from one tick to the next [s]
  /// Whether the client's own thread stood still, too, as at a breakpoint or if the computer slept. If not, only the
  /// game's thread did: a long frame, or a pause of the editor.
  bool whole = false;

  PACINIANCORE_API std::string text() const;  ///< in one line, for people
};

/// Complex sound pressure at each point [Pa]; empty if it was refused or the connection lost.
using FieldCallback = std::function<void(const std::vector<std::complex<float>>&)>;

/// What a game may listen to; all are called by `Client::tick`, on its thread.
struct Events {
  /// A session has begun, the first or a new one: nothing is there, so put the objects, and arm if it is wanted.
  std::function<void()> connected;
  /// The session is over, and with it all objects.
  std::function<void(const std::string& why)> lost;
  /// The sound ended unasked: its code is "owner", "stopped" or "fault"; without `resume` "expired", too.
  std::function<void(const Refusal&)> ended;
  std::function<void(const Refusal&)> refused;
  /// There is a newer state.
  std::function<void(const wire::State&)> state_changed;
  /// A hand begins to feel an object of this client's scene, feels it still, or no more; then as it was told last.
  /// Touches come with the states, 60 times a second.
  std::function<void(const wire::TouchState&)> touch_began, touch_moved, touch_ended;
  /// The game stood still. It sounds again by itself if it was armed with `resume`, still owns the output, and nothing
  /// else has ended the sound.
  std::function<void(const Standstill&)> stood_still;
};

}  // namespace pacinian
