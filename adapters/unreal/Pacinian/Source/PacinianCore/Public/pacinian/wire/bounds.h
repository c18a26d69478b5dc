#pragma once

#include <cstddef>
#include <limits>

namespace pacinian::wire {

/// The allowed values of a number. open: excludes `low` itself. Only the default allows NaN.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open = false;
  bool any = true;

  constexpr Range() = default;
  constexpr Range(double least, double most, bool without = false)
      : low(least), high(most), open(without), any(false) {}
  constexpr bool has(double value) const {
    return any || ((open ? value > low : value >= low) && value <= high);
  }
};

/// The allowed lengths.
struct Lengths {
  std::size_t least = 0;
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

}  // namespace pacinian::wire
