#include "pacinian/client/silence.h"

#include "inside.h"

namespace pacinian {

Silence Client::silence() const {
  const client::View& view = in_->view;
  if (view.status == Status::stopped)
    return {"not connected", "the client is not started, or has ended: call Start"};
  if (view.status != Status::connected)
    return {"not connected", view.problem.empty() ? "it is connecting" : view.problem};
  const wire::State* now = state();
  if (!now) return {};
  if (!now->owner.empty() && !view.owner && now->scene != view.scene)
    return {"not the owner",
            "\"" + now->owner + "\" owns the output: end that program, or arm with `take`"};
  return {now->cause, now->why};
}

}  // namespace pacinian
