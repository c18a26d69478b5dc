#include "touches.h"

#include <algorithm>
#include <utility>

namespace pacinian::client {

namespace {

using Several = std::vector<wire::TouchState>;

template <class Touches>
auto find(Touches& touches, const wire::TouchState& wanted) {
  return std::find_if(touches.begin(), touches.end(), [&](const wire::TouchState& touch) {
    return touch.object == wanted.object && touch.hand == wanted.hand;
  });
}

}  // namespace

void Touches::report_changes(const wire::State* state, const Events& on) {
  static const Several none;
  const Several& touches = state ? state->touches : none;
  const int cleared = cleared_;
  for (std::size_t i = now_.size(); i-- > 0 && cleared == cleared_;) {
    if (find(touches, now_[i]) != touches.end()) continue;
    const wire::TouchState ended = std::move(now_[i]);
    now_.erase(now_.begin() + static_cast<std::ptrdiff_t>(i));
    if (on.touch_ended) on.touch_ended(ended);
  }
  for (std::size_t i = 0; i < touches.size() && cleared == cleared_; ++i) {
    const auto known = find(now_, touches[i]);
    const auto& tell = known == now_.end() ? on.touch_began : on.touch_moved;
    if (known == now_.end())
      now_.push_back(touches[i]);
    else
      *known = touches[i];
    if (tell) tell(touches[i]);
  }
}

void Touches::clear() {
  now_.clear();
  ++cleared_;
}

}  // namespace pacinian::client
