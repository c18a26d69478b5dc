#include "pacinian/client/silence.h"

#include "client_impl.h"

namespace pacinian {

Silence Client::silence() const {
  const client::SessionStatus& view = in_->view;
  if (view.status == Status::stopped)
    return {"not connected", "the client is not started, or has ended: call Start"};
  if (view.status != Status::connected)
    return {"not connected", view.problem.empty() ? "it is connecting" : view.problem};
  const wire::State* now = state();
  if (!now) return {"not connected", "connected; the server has not sent its first state yet"};
  const bool ended = now->cause == "stopped" || now->cause == "fault";  // for every client
  if (!ended && !now->owner.empty() && !view.owner && now->scene != view.scene)
    return {"not the owner",
            "\"" + now->owner + "\" owns the output: end that program, or arm with `take`"};
  return {now->cause, now->why};
}

}  // namespace pacinian
