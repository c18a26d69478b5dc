#include "pacinian/client.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "object_validation.h"
#include "client_impl.h"
#include "pacinian/space/rigid.h"
#include "pacinian/wire/bulk.h"
#include "pacinian/wire/protocol.h"

namespace pacinian {

using client::Outbox;
using client::Request;
using client::Stamp;

namespace {

using Requests = std::vector<Request>;

float clamped(double place) {
  return static_cast<float>(std::max(-wire::MAX_COORDINATE, std::min(place, wire::MAX_COORDINATE)));
}

/// Returns a factor that makes a velocity no faster than the server accepts, also in single precision.
double shortening(const std::array<double, 3>& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return length > wire::MAX_SPEED ? wire::MAX_SPEED * (1.0 - 1e-6) / length : 1.0;
}

template <std::size_t N>
bool finite(const std::array<double, N>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

double steady_clock() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

template <class Act>
bool Client::Impl::tell(Act act) {
  return is_games_thread("a call") && worker && worker->mailbox().change_outgoing(session, act);
}

/// Returns whether the call comes from the thread that ticked last; before the first tick, from the one that called
/// first. Reports the first wrong call.
bool Client::Impl::is_games_thread(const char* call) {
  std::thread::id game;
  const std::thread::id self = std::this_thread::get_id();
  if (thread.compare_exchange_strong(game, self) || game == self) return true;
  const std::lock_guard<std::mutex> guard(lock);
  if (!std::exchange(told_thread, true)) wrong_call = call;
  return false;
}

template <class Act>
bool Client::Impl::command(Act act) {
  const Stamp stamp{options.clock(), options.life, true};
  return tell([&](Outbox& box, Requests&) { act(box, stamp); });
}

bool Client::Impl::ask(Request request) {
  return tell([&](Outbox&, Requests& requests) { requests.push_back(std::move(request)); });
}

/// Reports the first command without a session as a refusal. Does not report commands that are sent every frame.
bool Client::Impl::report_no_session(const char* what, bool done) {
  if (done || !is_games_thread(what) || std::exchange(told_no_session, true)) return done;
  const std::string start = worker ? "" : "call start, and ";
  refusals.push_back({"session", std::string("`") + what + "` was asked for, but there is no session", "",
                      start + "do it when on.connected is called"});
  return false;
}

/// Returns the highest radiation pressure that the server allows [Pa].
double Client::Impl::max_pressure() const {
  if (view.abilities)
    for (const auto& [name, limit] : view.abilities->limits)
      if (name == "pressure") return limit;
  return std::numeric_limits<double>::infinity();
}

bool Client::put(std::string_view name, wire::Object object) {
  Refusal why;
  if (in_->is_games_thread("put") && client::refuse(name, object, in_->max_pressure(), why)) {
    in_->refusals.push_back(std::move(why));
    return false;
  }
  return in_->report_no_session("put", in_->command([&](Outbox& box, Stamp stamp) {
    box.put(name, std::move(object), stamp);
  }));
}

bool Client::move(std::string_view name, const wire::Pose& pose, const wire::Motion* motion) {
  if (!client::is_name(name) || !finite(pose.position) || !finite(pose.rotation)) return false;
  if (motion && !(finite(motion->velocity) && finite(motion->angular_velocity))) return false;
  client::Place place{};
  client::Speed speed{};
  for (std::size_t i = 0; i < 3; ++i) {
    place[i] = clamped(pose.position[i]);
    if (!motion) continue;
    speed[i] = static_cast<float>(shortening(motion->velocity) * motion->velocity[i]);
    speed[i + 3] = static_cast<float>(shortening(motion->angular_velocity) * motion->angular_velocity[i]);
  }
  const auto& turn = pose.rotation;
  const Quat rotation = normalised({turn[0], turn[1], turn[2], turn[3]});
  const double parts[] = {rotation.x, rotation.y, rotation.z, rotation.w};
  for (std::size_t i = 0; i < 4; ++i) place[i + 3] = static_cast<float>(parts[i]);
  return in_->command([&](Outbox& box, Stamp stamp) {
    box.move(name, place, motion ? &speed : nullptr, stamp);
  });
}

bool Client::remove(std::string_view name) {
  if (!client::is_name(name)) return false;
  return in_->report_no_session("remove", in_->command([&](Outbox& box, Stamp stamp) { box.remove(name, stamp); }));
}

bool Client::clear() {
  return in_->report_no_session("clear", in_->command([](Outbox& box, Stamp stamp) { box.clear(stamp); }));
}

bool Client::envelope(std::string_view name, const wire::Envelope& envelope) {
  if (!client::is_name(name)) return false;
  return in_->report_no_session("envelope", in_->command([&](Outbox& box, Stamp stamp) {
    box.envelope(name, envelope, stamp);
  }));
}

bool Client::hands(const std::vector<wire::HandFrame>& hands, std::optional<double> seen) {
  return in_->command([&](Outbox& box, Stamp stamp) {
    if (seen && *seen < stamp.time) stamp.time = *seen;  // not if it is no number
    box.hands(hands, stamp);
  });
}

bool Client::quiet(const std::vector<wire::Zone>& zones) {
  return in_->report_no_session("quiet", in_->command([&](Outbox& box, Stamp stamp) { box.quiet(zones, stamp); }));
}

bool Client::arm(bool take, bool resume) {
  return in_->report_no_session("arm", in_->ask({Request::Kind::arm, take, resume}));
}

bool Client::disarm() { return in_->report_no_session("disarm", in_->ask({Request::Kind::disarm})); }

bool Client::reset() { return in_->report_no_session("reset", in_->ask({Request::Kind::reset})); }

bool Client::select(wire::Select choice) {
  return in_->report_no_session("select", in_->ask({Request::Kind::select, false, false, std::move(choice)}));
}

bool Client::field(const std::vector<std::array<float, 3>>& points, FieldCallback callback) {
  Request request{Request::Kind::field};
  for (const auto& point : points)
    for (const float value : point) wire::append(request.field.points, value);
  request.callback = std::move(callback);
  return in_->report_no_session("field", in_->ask(std::move(request)));
}

}  // namespace pacinian
