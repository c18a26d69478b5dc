#pragma once

#include <array>
#include <cstddef>

#include "pacinian/client/events.h"

namespace pacinian::client {

/// Estimates the offset of the server's clock, and the round trips. Does not read a clock: times are arguments [s].
class ServerClock {
 public:
  /// Records the round trip of a renewal. sent, received: of the client's clock.
  void add_round_trip(double sent, double received);

  /// Records a reading of the server's clock, taken between these times of the client's clock.
  void add_mark(double sent, double received, double server);

  /// Returns the round trips of the last renewals.
  const RoundTrips& round_trips() const { return summary_; }

  /// Returns the server's clock minus the client's, from the shortest recent round trip: the error is at most half of
  /// it.
  double offset() const;

  /// Returns the time since the server's clock was at `time`. now: of the client's clock.
  double age(double time, double now) const { return now + offset() - time; }

 private:
  struct Mark {
    double round_trip, offset;
  };
  std::array<double, 1000> round_trips_{}, ordered_{};
  std::array<Mark, 64> marks_{};
  RoundTrips summary_;
  std::size_t answers_ = 0, looks_ = 0;
};

}  // namespace pacinian::client
