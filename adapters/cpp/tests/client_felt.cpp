// RegionFelt finds an object by its name, and allocates nothing.

#include <initializer_list>

#include "../example/allocations.h"
#include "client_check.h"
#include "pacinian/client/region_felt.h"
#include "pacinian/wire/bulk.h"

namespace {

using pacinian::RegionFelt;
namespace wire = pacinian::wire;

constexpr float unknown = RegionFelt::unknown;

void by_name() {
  wire::State state;
  state.output = wire::Output::sounding;
  state.objects = {"point", "a ball whose name is long", "plate"};
  for (const float figure : {unknown, unknown, unknown, unknown, 0.98F, 0.06F, 0.0F, 1.3F, 1.0F, 0.5F, 0.25F, 0.125F})
    wire::append(state.felt, figure);
  example::thread = example::game;
  const RegionFelt ball = RegionFelt::of(&state, "a ball whose name is long");
  const RegionFelt plate = RegionFelt::of(&state, "plate");
  example::thread = example::others;
  EXPECT(example::allocations[example::game] == 0);
  EXPECT(ball.known() && ball.force == 0.98F && ball.rms == 0.06F && ball.holes == 0.0F && ball.spill == 1.3F);
  EXPECT(plate.known() && plate.force == 1.0F && plate.spill == 0.125F);
  EXPECT(!RegionFelt::of(&state, "point").known());
  EXPECT(!RegionFelt::of(&state, "gone").known());
  EXPECT(!RegionFelt::of(nullptr, "plate").known());
  state.output = wire::Output::silent;
  EXPECT(!RegionFelt::of(&state, "plate").known());
  state.output = wire::Output::sounding;
  wire::append(state.felt, 1.0F);  // not four numbers for each object
  EXPECT(!RegionFelt::of(&state, "plate").known());
}

}  // namespace

int main() {
  by_name();
  return check::result();
}
