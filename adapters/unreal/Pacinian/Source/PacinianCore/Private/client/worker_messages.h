#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "pacinian/client/events.h"
#include "pacinian/wire/commands.h"
#include "pacinian/wire/control.h"
#include "pacinian/wire/replies.h"

namespace pacinian::client {

/// An event for the game's thread.
struct Event {
  enum class Kind : std::uint8_t { connected, lost, ended, refused, field };
  Kind kind = Kind::connected;
  Refusal refusal;            ///< for `lost` only the message
  std::uint64_t session = 0;  ///< the session that has begun
  FieldCallback callback = {};
  wire::Bytes pressures = {};
};

/// The status of a session.
struct SessionStatus {
  Status status = Status::stopped;
  bool armed = false, owner = false;
  double lease = 0.0, offset = 0.0;  ///< [s]
  RoundTrips round_trips;
  std::string problem, scene, server;
  std::shared_ptr<const wire::Abilities> abilities;
};

/// A request of the game.
struct Request {
  enum class Kind : std::uint8_t { arm, disarm, reset, select, field };
  Kind kind = Kind::arm;
  bool take = false, resume = false;
  wire::Select choice = {};
  wire::Field field = {};
  FieldCallback callback = {};
};

}  // namespace pacinian::client
