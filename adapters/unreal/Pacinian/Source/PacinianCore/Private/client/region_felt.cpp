#include "pacinian/client/region_felt.h"

#include "pacinian/wire/bulk.h"

namespace pacinian {

RegionFelt RegionFelt::of(const wire::State* state, std::string_view name) {
  constexpr std::size_t row = 4 * sizeof(float);
  if (!state || state->output != wire::Output::sounding) return {};
  if (state->felt.size() != row * state->objects.size()) return {};
  for (std::size_t i = 0; i < state->objects.size(); ++i) {
    if (state->objects[i] != name) continue;
    const auto figure = [&](std::size_t k) { return wire::float_at(state->felt, 4 * i + k); };
    return {figure(0), figure(1), figure(2), figure(3)};
  }
  return {};
}

}  // namespace pacinian
