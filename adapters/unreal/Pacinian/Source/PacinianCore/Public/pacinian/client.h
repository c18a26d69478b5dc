#pragma once

#include <array>
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

/// A session with `pacinian serve`. Belongs to one thread, the game's, but for `stop`; never blocks it. Calls from another
/// thread than the one that ticks do nothing, and `on.refused` tells that.
///
/// A thread of its own connects, and again after each loss, sends, and listens. Of what has not been sent yet only the
/// newest for each object is kept. The lease is renewed only as long as `tick` is called, so that a game that hangs
/// falls silent until it goes on. After a loss nothing resumes: objects must be put again, and the output armed.
///
/// What returns bool is false, and does nothing, without a session; `on.refused` tells that once, and what the server
/// refuses.
class Client {
 public:
  PACINIANCORE_API explicit Client(Options options = {});
  PACINIANCORE_API ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  Events on;

  /// Begins to connect.
  PACINIANCORE_API void start();
  /// Says bye, if there is a session: silence, if this client owns the output. Takes at most half a second.
  PACINIANCORE_API void close();
  /// Once in each of the game's frames: it is alive. Takes over the newest state, and calls `on`.
  PACINIANCORE_API void tick();

  // As of the last tick.
  PACINIANCORE_API Status status() const;
  PACINIANCORE_API const std::string& problem() const;  ///< why it is not connected, and what to do
  PACINIANCORE_API bool armed() const;                  ///< whether this client's scene may be felt
  PACINIANCORE_API bool owner() const;                  ///< whether the output is its own
  PACINIANCORE_API double lease() const;                ///< from the last tick to silence [s]
  PACINIANCORE_API double latency() const;              ///< median round trip of the last renewals [s]
  PACINIANCORE_API Trips trips() const;
  PACINIANCORE_API double offset() const;               ///< the server's clock less ours [s]
  PACINIANCORE_API const std::string& scene() const;    ///< its name
  PACINIANCORE_API const std::string& server() const;   ///< what the server says that it is
  PACINIANCORE_API const wire::Abilities* capabilities() const;  ///< null without a session
  PACINIANCORE_API const wire::State* state() const;             ///< the newest; null before the first
  /// What is felt of an object's surface or volume, by its name, in the newest state.
  PACINIANCORE_API RegionFelt felt(std::string_view name) const;
  /// Why the output is silent, and what to do; empty while it sounds. As of the newest state.
  PACINIANCORE_API Silence silence() const;
  /// Hands that feel an object of this client's scene.
  PACINIANCORE_API const std::vector<wire::TouchState>& touches() const;

  /// Its clock [s].
  PACINIANCORE_API double now() const;
  /// How long ago a state was published [s]; right to half of the shortest round trip.
  PACINIANCORE_API double age(const wire::State& state) const;

  /// An object of that name: new, or in place of the one before. What the server would refuse is refused here, by name:
  /// false, and `on.refused` is called by the next tick.
  PACINIANCORE_API bool put(std::string_view name, wire::Object object);
  /// A new pose. motion: from now on; unless given it stands still. What is beyond 10 m or 100 m/s is taken for that.
  PACINIANCORE_API bool move(std::string_view name, const wire::Pose& pose,
                             const wire::Motion* motion = nullptr);
  PACINIANCORE_API bool remove(std::string_view name);
  /// Takes away all objects, hands and quiet zones of this client.
  PACINIANCORE_API bool clear();
  /// How strong an object that is there is over time, from now on.
  PACINIANCORE_API bool envelope(std::string_view name, const wire::Envelope& envelope);
  /// All hands that are tracked, in place of those before; from then on only hands feel the scene.
  /// seen: when, by the client's clock [s]; now unless given.
  PACINIANCORE_API bool hands(const std::vector<wire::HandFrame>& hands,
                              std::optional<double> seen = std::nullopt);
  /// All quiet zones of this client, in place of those before.
  PACINIANCORE_API bool quiet(const std::vector<wire::Zone>& zones);

  /// This client's scene is to be felt, as long as `tick` is called. take: from its owner, if need be. resume: if the
  /// game stands still for longer than its lease, it sounds again when it goes on; otherwise it is to be armed again.
  PACINIANCORE_API bool arm(bool take = false, bool resume = true);
  /// Silence, softly; the output is let go.
  PACINIANCORE_API bool disarm();
  /// Emergency stop: silence at once, whoever owns the output, until `reset`. From any thread, with or without a
  /// session; if the server does not confirm it, `on.refused` tells.
  PACINIANCORE_API void stop();
  /// After an emergency stop or a fault: it may be armed again.
  PACINIANCORE_API bool reset();
  /// Another solver, backend, technique or intensity; what is not given stays. Done when the state says so.
  PACINIANCORE_API bool select(wire::Select choice);
  /// Asks for the sound pressure at points [m] of what is emitted now.
  PACINIANCORE_API bool field(const std::vector<std::array<float, 3>>& points, FieldCallback told);

 private:
  struct Impl;
  std::unique_ptr<Impl> in_;
};

}  // namespace pacinian
