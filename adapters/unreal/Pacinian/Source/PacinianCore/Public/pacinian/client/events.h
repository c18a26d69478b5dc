#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pacinian/api.h"
#include "pacinian/wire/state.h"

namespace pacinian {

/// The state of a client's connection.
enum class Status : std::uint8_t {
  stopped,     ///< not started, or closed
  connecting,  ///< no server is connected; the client tries again and again
  connected,
  refused,  ///< the server rejects the client until something is changed: see `Client::problem`
};

/// A command or request that the server, or the client itself, refused.
struct Refusal {
  std::string code;     ///< from the wire's table of errors
  std::string message;  ///< for people
  std::string path;     ///< of the wrong field, such as `$.objects[...].shape`
  std::string advice;   ///< what to do

  PACINIANCORE_API std::string text() const;  ///< in one line, without what is empty
};

/// Round trips of the last renewals [s]; 0 before the first.
struct RoundTrips {
  double median = 0.0, p99 = 0.0, longest = 0.0;
};

/// A standstill that is over: the game did not tick for longer than its lease while it was armed.
struct Standstill {
  double seconds = 0.0;  ///< time between the two ticks [s]
  /// Whether the whole program stood still, including the client's thread, as at a breakpoint or while the computer
  /// slept. If false, only the game's thread stood still, as in a long frame or a pause of the editor.
  bool whole = false;

  PACINIANCORE_API std::string text() const;  ///< a description in one line
};

/// Receives the complex sound pressure at each point [Pa]; empty if there is no answer.
using FieldCallback = std::function<void(const std::vector<std::complex<float>>&)>;

/// Event handlers. `Client::tick` calls them, on its thread.
struct Events {
  /// A session has started, with an empty scene. Put the objects, and arm. A session that begins and ends between two
  /// ticks is not reported.
  std::function<void()> connected;
  /// The session has ended, and with it all objects.
  std::function<void(const std::string& why)> lost;
  /// The output ended unasked. The code is "owner", "stopped" or "fault"; without `resume` also "expired".
  std::function<void(const Refusal&)> ended;
  std::function<void(const Refusal&)> refused;
  /// A newer state has arrived.
  std::function<void(const wire::State&)> state_changed;
  /// A hand begins to feel an object of this client's scene, still feels it, or no longer feels it; then with the last
  /// report. Touches arrive with the states, 60 times a second.
  std::function<void(const wire::TouchState&)> touch_began, touch_moved, touch_ended;
  /// The game stood still, and its session goes on. The output sounds again by itself if the client armed it with `resume` and still owns it,
  /// and if nothing else has ended the sound.
  std::function<void(const Standstill&)> stood_still;
};

}  // namespace pacinian
