#include "pacinian/wire/bulk.h"

#include <algorithm>
#include <string>

#include "pacinian/wire/reader.h"

namespace pacinian::wire {

bool rows(Reader& in, const char* name, const Bytes& data, std::size_t width,
          std::initializer_list<std::size_t> counts) {
  const std::size_t size = data.size();
  const std::size_t found = size / (4 * width);
  const bool counted =
      counts.size() == 0 || std::find(counts.begin(), counts.end(), found) != counts.end();
  if (size % (4 * width) == 0 && counted) return true;
  const std::string wanted = counts.size() == 0 ? "" : std::to_string(*counts.begin()) + " ";
  in.wrong("must be " + wanted + "rows of " + std::to_string(width) + " float32, not " +
           std::to_string(size) + " bytes");
  return in.at(name);
}

bool within(Reader& in, const char* name, const Bytes& data, double low, double high) {
  for (std::size_t i = 0; i < data.size() / 4; ++i) {
    const double value = static_cast<double>(float_at(data, i));
    if (value >= low && value <= high) continue;
    in.wrong("must be from " + std::to_string(low) + " to " + std::to_string(high) +
             ", without NaN");
    return in.at(name);
  }
  return true;
}

bool in_bounds(Reader& in, const char* name, const Bytes& data, const Bytes& into) {
  const std::size_t below = into.size() / 12;
  bool good = data.size() % 12 == 0;
  for (std::size_t i = 0; good && i < data.size() / 4; ++i) good = uint32_at(data, i) < below;
  if (good) return true;
  in.wrong("must be rows of 3 uint32 below " + std::to_string(below));
  return in.at(name);
}

}  // namespace pacinian::wire
