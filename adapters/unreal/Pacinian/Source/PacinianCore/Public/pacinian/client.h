#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pacinian/api.h"
#include "pacinian/client/events.h"
#include "pacinian/client/options.h"
#include "pacinian/client/region_felt.h"
#include "pacinian/client/silence.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/control.h"
#include "pacinian/wire/replies.h"
#include "pacinian/wire/state.h"

namespace pacinian {

/// A client of `pacinian serve`. All methods except `stop` belong to the game's thread, which calls `tick`, and none
/// blocks it. Calls from another thread do nothing; `on.refused` reports them.
///
/// A worker thread connects and reconnects, sends and receives. A command that waits to be sent is dropped if a newer
/// command replaces it. The lease is renewed only while `tick` is called, so a game that hangs falls silent until it
/// continues. After a loss nothing resumes: put the objects again, and arm the output.
///
/// Without a session, methods that return bool do nothing and return false; `on.refused` reports this once. It also
/// reports what the server refuses.
class Client {
 public:
  PACINIANCORE_API explicit Client(Options options = {});
  PACINIANCORE_API ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  Events on;

  /// Starts to connect; again after `close`.
  PACINIANCORE_API void start();
  /// Ends the session, and the sound if this client owns the output. Blocks for half a second at most.
  PACINIANCORE_API void close();
  /// Renews the lease, takes the newest state and calls `on`; call it once per frame.
  PACINIANCORE_API void tick();

  // The methods below return the state as of the last tick.
  PACINIANCORE_API Status status() const;
  PACINIANCORE_API const std::string& problem() const;  ///< why there is no session, and what to do
  PACINIANCORE_API bool armed() const;                  ///< whether this client has armed the output and owns it
  PACINIANCORE_API bool owner() const;                  ///< whether this client owns the output
  PACINIANCORE_API double lease() const;                ///< time from the last tick to silence [s]
  PACINIANCORE_API double latency() const;              ///< median round trip of the last renewals [s]
  PACINIANCORE_API RoundTrips round_trips() const;
  PACINIANCORE_API double offset() const;               ///< the server's clock minus the client's [s]
  PACINIANCORE_API const std::string& scene() const;    ///< name of the scene
  PACINIANCORE_API const std::string& server() const;   ///< the server's description of itself
  PACINIANCORE_API const wire::Abilities* capabilities() const;  ///< null without a session
  PACINIANCORE_API const wire::State* state() const;             ///< the newest; null before the first
  /// Returns the achieved and the requested pressure of an object's surface or volume, from the newest state.
  PACINIANCORE_API RegionFelt felt(std::string_view name) const;
  /// Returns why the output is silent, and what to do, from the newest state; empty while it sounds.
  PACINIANCORE_API Silence silence() const;
  /// Returns the hands that now feel an object of this client's scene.
  PACINIANCORE_API const std::vector<wire::TouchState>& touches() const;

  /// Returns the client's clock [s].
  PACINIANCORE_API double now() const;
  /// Returns the time since a state was published [s]; the error is at most half of the shortest round trip.
  PACINIANCORE_API double age(const wire::State& state) const;

  /// Adds an object, or replaces the one with this name. If a field is wrong by the wire's rules, or the radiation pressure
  /// higher than the server allows, returns false, and the next tick calls `on.refused` with the object's name. What only
  /// the server can check, such as whether a mesh is closed, it refuses later; then `on.refused` is called, too.
  PACINIANCORE_API bool put(std::string_view name, wire::Object object);
  /// Moves an existing object. motion: its velocities from now on; null: none. Clamps to 10 m along each
  /// axis and to 100 m/s; returns false for numbers that are not finite.
  PACINIANCORE_API bool move(std::string_view name, const wire::Pose& pose,
                             const wire::Motion* motion = nullptr);
  PACINIANCORE_API bool remove(std::string_view name);
  /// Removes all objects, hands and quiet zones of this client.
  PACINIANCORE_API bool clear();
  /// Replaces the envelope of an existing object.
  PACINIANCORE_API bool envelope(std::string_view name, const wire::Envelope& envelope);
  /// Replaces all tracked hands. From then on, objects are felt only where hands touch them. seen: the time of the
  /// hands by the client's clock [s]; now by default.
  PACINIANCORE_API bool hands(const std::vector<wire::HandFrame>& hands,
                              std::optional<double> seen = std::nullopt);
  /// Replaces all quiet zones of this client.
  PACINIANCORE_API bool quiet(const std::vector<wire::Zone>& zones);

  /// Arms the output: this client's scene is felt while `tick` is called. take: takes the output from its owner.
  /// resume: after a standstill of more than the lease, the next tick lets the output sound again; if false, arm again.
  PACINIANCORE_API bool arm(bool take = false, bool resume = true);
  /// Disarms: the sound fades, and the output is released.
  PACINIANCORE_API bool disarm();
  /// Emergency stop: silences the array at once, whoever owns the output, until `reset`. May be called from any thread,
  /// with or without a session. If the server does not confirm the stop, the next tick calls `on.refused`. refused: is
  /// called then, too, at once and on another thread, for programs that do not tick; of the client it may
  /// call only `stop`.
  PACINIANCORE_API void stop(std::function<void(const Refusal&)> refused = {});
  /// Allows arming again after an emergency stop or a fault.
  PACINIANCORE_API bool reset();
  /// Changes the solver, backend, technique or intensity; what is not given stays. The state shows when it is done.
  PACINIANCORE_API bool select(wire::Select choice);
  /// Requests the sound pressure that is now emitted at points [m].
  PACINIANCORE_API bool field(const std::vector<std::array<float, 3>>& points, FieldCallback callback);

 private:
  struct Impl;
  std::unique_ptr<Impl> in_;
};

}  // namespace pacinian
