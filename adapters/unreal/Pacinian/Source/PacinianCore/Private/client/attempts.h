#pragma once

#include <string>

#include "loss.h"
#include "pacinian/client/events.h"

namespace pacinian::client {

/// When to connect, and what people are told until it is done: pure, with the time given [s].
class Attempts {
 public:
  static constexpr double shortest = 0.1, longest = 2.0;  ///< [s] between two

  Status status() const { return status_; }
  const std::string& problem() const { return problem_; }

  /// When the next one is to begin.
  double due() const { return due_; }

  void succeeded();

  /// One failed, or a session was lost.
  void failed(const Loss& loss, double now);

 private:
  Status status_ = Status::connecting;
  std::string problem_;
  double due_ = 0.0, pause_ = shortest;
};

}  // namespace pacinian::client
