// Tests of the outbox, the reconnect pauses and the round trips.

#include <cmath>

#include "client/reconnect_backoff.h"
#include "client/object_validation.h"
#include "client/outbox.h"
#include "client/server_clock.h"
#include "client_check.h"
#include "client_scene.h"

namespace {

using check::Sink;
using pacinian::Status;
using pacinian::client::ReconnectBackoff;
using pacinian::client::CommandSender;
using pacinian::client::Outbox;
using pacinian::client::Place;
using pacinian::client::Speed;
using pacinian::client::Stamp;
using pacinian::client::ServerClock;
namespace wire = pacinian::wire;

struct Box : Outbox {
  bool flush(double now) {
    CommandSender courier{sink, session, sequence, writer};
    return Outbox::flush(now, courier);
  }
  template <class T>
  std::vector<T> sent() const {
    return Sink::of<T>(sink.commands);
  }

  Sink sink;
  wire::Bytes session = wire::Bytes(16, 1);
  std::int64_t sequence = 0;
  wire::Writer writer;
};

Stamp at(double time, double ttl = 1.0) { return {time, ttl, true}; }

Place place(float x) { return {x, 0.0F, 0.2F, 0.0F, 0.0F, 0.0F, 1.0F}; }

void newest_wins() {
  Box box;
  box.sink.full = true;
  box.put("a", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  for (int i = 0; i < 200; ++i) {
    box.move("a", place(0.001F * static_cast<float>(i)), nullptr, at(0.001 * i));
    box.hands({}, at(0.001 * i));
    EXPECT(!box.flush(0.001 * i));
  }
  EXPECT(box.sink.commands.empty());
  box.sink.full = false;
  EXPECT(box.flush(0.2));
  EXPECT(box.empty());
  EXPECT(box.sink.commands.size() == 3);  // put, move, hands
  EXPECT(std::holds_alternative<wire::Put>(box.sink.commands[0]));
  const auto moves = box.sent<wire::Move>();
  EXPECT(moves.size() == 1 && moves[0].names == std::vector<std::string>{"a"});
  EXPECT(std::fabs(wire::float_at(moves[0].poses, 0) - 0.199F) < 1e-6F);
  EXPECT(moves[0].time == 0.199 && moves[0].velocities.empty());
  EXPECT(box.sent<wire::Hands>()[0].sequence > moves[0].sequence);
}

void later_ones_undo_earlier_ones() {
  Box box;
  box.put("a", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  box.move("a", place(0.1F), nullptr, at(0.0));
  box.remove("a", at(0.0));
  box.put("b", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  box.remove("c", at(0.0));
  box.put("c", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  EXPECT(box.flush(0.0));
  EXPECT(box.sent<wire::Move>().empty());
  EXPECT(box.sent<wire::Remove>()[0].names == std::vector<std::string>{"a"});
  EXPECT(box.sent<wire::Put>()[0].objects.size() == 2);
  box.put("a", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  box.quiet({}, at(0.0));
  box.clear(at(0.0));
  box.hands({}, at(0.0));
  box.sink.commands.clear();
  EXPECT(box.flush(0.0));
  EXPECT(box.sink.commands.size() == 2);
  EXPECT(box.sent<wire::Clear>().size() == 1 && box.sent<wire::Hands>().size() == 1);
}

void too_old_is_dropped() {
  Box box;
  box.move("a", place(0.0F), nullptr, at(0.0, 0.1));
  box.move("b", place(0.0F), nullptr, at(0.0, 0.3));
  EXPECT(box.flush(0.2));
  EXPECT(box.sent<wire::Move>().size() == 1);
  EXPECT(box.sent<wire::Move>()[0].names == std::vector<std::string>{"b"});
}

void what_is_newer_goes_over() {
  Box box, newer;
  const Speed speed = {1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  box.put("a", scene::point(0.0, 0.0, 0.2, 5.0), at(0.0));
  box.move("b", place(0.1F), nullptr, at(0.0));
  newer.move("b", place(0.2F), &speed, at(0.001));
  newer.move("c", place(0.3F), nullptr, at(0.001));
  newer.envelope("a", wire::Constant{}, at(0.001));
  box.take(newer);
  EXPECT(newer.empty());
  EXPECT(box.flush(0.002));
  const auto moves = box.sent<wire::Move>();
  EXPECT(moves.size() == 1 && moves[0].names.size() == 2);
  EXPECT(moves[0].velocities.size() == 48 && wire::float_at(moves[0].velocities, 0) == 1.0F);
  EXPECT(box.sent<wire::Put>().size() == 1 && box.sent<wire::Envelopes>().size() == 1);
}

void messages_are_small_enough() {
  Box box;
  for (int i = 0; i < 600; ++i) box.move(std::to_string(i), place(0.0F), nullptr, at(0.0));
  EXPECT(box.flush(0.0));
  EXPECT(box.sent<wire::Move>().size() == 3);
  wire::Particles large;
  large.radiation_pressure = 5.0;
  large.positions.assign(120'000, 0);
  for (int i = 0; i < 20; ++i) box.put(std::to_string(i), large, at(0.0));
  EXPECT(box.flush(0.0));
  EXPECT(box.sent<wire::Put>().size() == 3);  // 2.4 MB
  wire::Surface huge;
  wire::HeightMap map;
  map.heights.assign(4 * 200'000, 0);
  map.grid = {400, 500};
  map.width = map.height = 0.1;
  huge.radiation_pressure = 5.0;
  huge.shape = map;
  box.put("huge", huge, at(0.0));
  EXPECT(box.flush(0.0) && box.sent<wire::Put>().size() == 4);
}

void what_the_server_would_refuse_is_found() {
  const auto refused = [](const std::string& name, const wire::Object& object, const std::string& path, const char* says) {
    pacinian::Refusal why;
    return pacinian::client::refuse(name, object, 200.0, why) && why.path == path && why.message.find(says) != std::string::npos;
  };
  pacinian::Refusal why;
  const wire::Object good = scene::point(0.0, 0.0, 0.2, 5.0);
  EXPECT(!pacinian::client::refuse("good", good, 200.0, why));
  EXPECT(!pacinian::client::refuse(std::string(63, 'n') + "\xC3\xA4", good, 200.0, why));  // 64 characters, 65 bytes
  EXPECT(refused(std::string(65, 'n'), good, "$.objects[" + std::string(65, 'n') + "]", "1 to 64 characters"));
  EXPECT(refused("", good, "$.objects[]", "1 to 64 characters"));
  EXPECT(refused("far", scene::point(0.0, 0.0, 20.0, 5.0), "$.objects[far].position[2]", "10"));
  EXPECT(refused("nan", scene::point(0.0, NAN, 0.2, 5.0), "$.objects[nan].position[1]", ""));
  EXPECT(refused("mute", scene::ball(0.03, 0.0), "$.objects[mute]", "a radiation pressure or a force"));
  const auto waves = [](const wire::Envelope& envelope) {
    wire::Volume made = scene::ball(0.03, 5.0);
    made.envelope = envelope;
    return made;
  };
  EXPECT(!pacinian::client::refuse("good", waves(wire::Pulse{0.1, 0.1, 0.0, 0.05, 0.3, 0.3}), 200.0, why));
  EXPECT(!pacinian::client::refuse("good", waves(wire::Noise{99.0, 100.0}), 200.0, why));
  EXPECT(refused("a", waves(wire::Sine{150.0, 0.9, 0.1}), "$.objects[a].envelope.high", "at least `low`"));
  EXPECT(refused("a", waves(wire::Square{150.0, 0.9, 0.1}), "$.objects[a].envelope.high", "at least `low`"));
  EXPECT(refused("a", waves(wire::Noise{200.0, 100.0}), "$.objects[a].envelope.low_frequency", "below `high_frequency`"));
  EXPECT(refused("a", waves(wire::Pulse{0.5, 0.1}), "$.objects[a].envelope.period", "at least the width"));
  EXPECT(refused("a", waves(wire::Pulse{0.5, 1.0, 0.0, 0.4}), "$.objects[a].envelope.rise", "half of the width"));
  wire::Volume turned = scene::ball(0.03, 5.0);
  turned.pose.rotation = {0.0, 0.0, 0.6, 0.804};
  EXPECT(!pacinian::client::refuse("good", turned, 200.0, why));  // the server normalises it
  turned.pose.rotation = {0.0, 0.0, 0.0, 0.0};
  EXPECT(refused("a", turned, "$.objects[a].pose.rotation", "length 1"));
  wire::Point runs = scene::point(0.0, 0.0, 0.2, 5.0);
  wire::STM path;
  path.frequency = 100.0;
  path.dwell = 0.005;
  runs.technique = path;
  EXPECT(!pacinian::client::refuse("good", runs, 200.0, why));
  path.dwell = 0.02;
  runs.technique = path;
  EXPECT(refused("a", runs, "$.objects[a].technique.dwell", "the period"));
  wire::Particles large;
  large.radiation_pressure = 5.0;
  large.positions.assign(12 * 100'000, 0);
  EXPECT(refused("large", large, "$.objects[large]", "bytes: keep to"));
}

void pauses_grow_and_shrink() {
  ReconnectBackoff attempts;
  EXPECT(attempts.status() == Status::connecting && attempts.due() <= 0.0);
  double now = 5.0, expected = 0.1;
  for (int i = 0; i < 8; ++i, expected = std::fmin(2.0, 2.0 * expected)) {
    attempts.record_failure({"nobody", false}, now);
    EXPECT(std::fabs(attempts.due() - now - expected) < 1e-9);
    now = attempts.due();
  }
  EXPECT(attempts.status() == Status::connecting && attempts.problem() == "nobody");
  attempts.record_success();
  EXPECT(attempts.status() == Status::connected && attempts.problem().empty());
  attempts.record_failure({"has gone", false}, now);
  EXPECT(std::fabs(attempts.due() - now - 0.1) < 1e-9);
  attempts.record_failure({"update the server", true}, now);
  EXPECT(attempts.status() == Status::refused && attempts.due() > now);
  for (int i = 0; i < 8; ++i)
    attempts.record_failure({"no connection file", false}, now, ReconnectBackoff::max_pause_without_server);
  EXPECT(std::fabs(attempts.due() - now - 0.5) < 1e-9);
}

void refusals_are_told_without_what_is_empty() {
  EXPECT(pacinian::Refusal({"limit", "is too large", "", ""}).text() == "limit: is too large");
  EXPECT(pacinian::Refusal({"stopped", "no", "$.id", "reset first"}).text() == "stopped: no ($.id); reset first");
}

void round_trips() {
  ServerClock server_clock;
  EXPECT(server_clock.round_trips().median == 0.0 && server_clock.offset() == 0.0);
  for (int i = 1; i <= 300; ++i) {
    server_clock.add_round_trip(0.0, i);
    server_clock.add_mark(i, i + (i % 7 ? 0.01 : 0.001), i + 100.0 + (i % 7 ? 0.009 : 0.0005));
  }
  EXPECT(server_clock.round_trips().median == 150.0 && server_clock.round_trips().longest == 300.0);
  EXPECT(server_clock.round_trips().p99 == 297.0);
  EXPECT(std::fabs(server_clock.offset() - 100.0) < 1e-9);
  EXPECT(std::fabs(server_clock.age(400.0, 301.0) - 1.0) < 1e-9);
}

}  // namespace

int main() {
  newest_wins();
  later_ones_undo_earlier_ones();
  too_old_is_dropped();
  what_is_newer_goes_over();
  messages_are_small_enough();
  what_the_server_would_refuse_is_found();
  pauses_grow_and_shrink();
  refusals_are_told_without_what_is_empty();
  round_trips();
  return check::result();
}
