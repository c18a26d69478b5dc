#pragma once

#include <array>
#include <cstddef>

#include "pacinian/client/events.h"

namespace pacinian::client {

/// Round trips, and how the server's clock lies to ours: pure, with times given [s].
class Timing {
 public:
  /// A renewal was sent, and its answer received, at these times of our clock.
  void answered(double sent, double received);

  /// The server's clock was at `server` some time between.
  void clocked(double sent, double received, double server);

  /// Of the last round trips.
  const Trips& trips() const { return told_; }

  /// Server's clock less ours, from the shortest round trip of late: off by at most half of it.
  double offset() const;

  /// How long ago, at `now` of our clock, the server's clock was at `time`.
  double age(double time, double now) const { return now + offset() - time; }

 private:
  struct Mark {
    double trip, offset;
  };
  std::array<double, 1000> trips_{}, ordered_{};
  std::array<Mark, 64> marks_{};
  Trips told_;
  std::size_t answers_ = 0, looks_ = 0;
};

}  // namespace pacinian::client
