// What a call takes of a game's frame.
#pragma once

#include <sys/resource.h>

#include <ctime>

namespace driver {

/// From when it is made, how long this thread is at something [s]: all of the time where it waited for anything, else
/// that of the processor. What others take of the machine meanwhile is no fault of the call; but of waiting by yielding
/// only the processor's time counts, and one short wait for a lock counts all.
class Spent {
 public:
  double seconds() const {
    return waits() > waits_ ? of(CLOCK_MONOTONIC) - begin_ : of(CLOCK_THREAD_CPUTIME_ID) - processor_;
  }

 private:
  static double of(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  /// How often the thread has given up the processor by itself.
  static long waits() {
    rusage used{};
    getrusage(RUSAGE_THREAD, &used);
    return used.ru_nvcsw;
  }

  double begin_ = of(CLOCK_MONOTONIC), processor_ = of(CLOCK_THREAD_CPUTIME_ID);
  long waits_ = waits();
};

}  // namespace driver
