// Tests of ServerSession without a socket, and with the test's own clock.

#include "client/mailbox.h"
#include "client_talk.h"

namespace {

using pacinian::client::Event;
using pacinian::client::Request;
using talk::Talk;
namespace wire = pacinian::wire;

void a_session_begins() {
  Talk talk;
  talk.sink.full = true;
  talk.begin(talk.now);
  talk.send();  // not connected yet
  EXPECT(talk.sink.controls.empty());
  talk.sink.full = false;
  talk.connect();
  EXPECT(talk.connected() && !talk.armed && talk.abilities);
  EXPECT(talk.events.size() == 1 && talk.events[0].kind == Event::Kind::connected);
}

void only_ticks_renew() {
  Talk talk;
  talk.connect();
  EXPECT(talk.renewals(101.0) == 0 && talk.wants_tick(talk.now));
  talk.record_tick(101.0);
  EXPECT(talk.renewals(102.0) == 1);  // the game is frozen
  EXPECT(talk.sent<wire::Renew>().back().time == 101.0);
  for (int i = 0; i < 90; ++i) {
    talk.record_tick(talk.now);
    talk.renewals(talk.now + 1.0 / 90.0);
  }
  const std::size_t all = talk.sent<wire::Renew>().size();
  EXPECT(all > 25 && all < 40);  // about eight in a lease
  const auto sequences = talk.sent<wire::Renew>();
  for (std::size_t i = 1; i < all; ++i) EXPECT(sequences[i].sequence > sequences[i - 1].sequence);
}

void an_old_tick_does_not_renew_a_new_session() {
  Talk talk;
  talk.connect();
  talk.record_tick(talk.now);
  talk.set_lost({"has gone", false});
  talk.now += 1.0;
  talk.connect();
  EXPECT(talk.renewals(talk.now + 1.0) == 0);
}

void another_version_says_which_side_to_update() {
  for (const std::int64_t major : {0, 2}) {
    Talk talk;
    talk.begin(talk.now);
    talk.send();
    talk.reply(talk.welcoming(major));
    EXPECT(talk.loss() && talk.loss()->refused && !talk.connected());
    const char* advice = major == 0 ? "update the server" : "update the client";
    EXPECT(talk.loss()->why.find(advice) != std::string::npos);
    EXPECT(talk.events.size() == 1 && talk.events[0].refusal.code == "version");
    talk.begin(talk.now);
    talk.send();
    talk.reply(talk.welcoming(major));
    EXPECT(talk.events.size() == 1);  // reported once
  }
  Talk talk;
  talk.begin(talk.now);
  talk.send();
  talk.fail(talk.sent<wire::Hello>().back().id, wire::Code::version, "the client speaks protocol 1");
  EXPECT(talk.loss() && talk.loss()->why.find("update the older") != std::string::npos);
}

void nothing_resumes() {
  Talk talk;
  talk.connect();
  talk.add_request({Request::Kind::arm}, talk.now);
  talk.send();
  talk.ok(talk.sent<wire::Arm>().back().id);
  EXPECT(talk.armed && talk.owner);
  talk.sink.full = true;
  talk.add_request({Request::Kind::reset}, talk.now);
  Request field{Request::Kind::field};
  int told = 0;
  field.callback = [&](const auto& pressures) { told += pressures.empty(); };
  talk.add_request(std::move(field), talk.now);
  talk.send();
  talk.sink.full = false;
  talk.events.clear();
  talk.fail(0, wire::Code::session, "the bus was started anew");
  EXPECT(talk.loss() && !talk.armed && !talk.owner && !talk.connected());
  EXPECT(talk.events.size() == 2 && talk.events[0].kind == Event::Kind::lost);
  if (talk.events[1].callback) talk.events[1].callback({});
  EXPECT(told == 1);
  talk.connect();
  talk.record_tick(talk.now);
  talk.renewals(talk.now + 0.1);
  EXPECT(talk.sent<wire::Arm>().size() == 1 && talk.sent<wire::Reset>().empty());
  EXPECT(talk.sent<wire::Renew>().back().session == wire::Bytes(16, 2));
}

void ends_of_sound_before_arm_are_forgotten() {
  Talk talk;
  talk.connect();
  talk.events.clear();
  talk.fail(0, wire::Code::expired);
  EXPECT(talk.events.size() == 1 && talk.events[0].kind == Event::Kind::ended);
  talk.add_request({Request::Kind::arm}, talk.now);
  talk.send();
  talk.ok(talk.sent<wire::Arm>().back().id);
  EXPECT(talk.forget_ended);
  talk.fail(0, wire::Code::owner);
  EXPECT(!talk.armed && talk.events.size() == 2);
  talk.fail(0, wire::Code::stale);
  EXPECT(talk.events.back().kind == Event::Kind::refused);
}

void silence_of_the_server_is_a_loss() {
  Talk asked, hangs;
  asked.connect();
  asked.add_request({Request::Kind::reset}, asked.now);
  asked.send();
  EXPECT(asked.due(asked.now) <= asked.now + 2.0);
  asked.now += 5.0;
  asked.handle_message(nullptr, 0, asked.now);  // not a message, but a sign of life
  asked.check_timeouts(asked.now);
  EXPECT(asked.loss() && asked.loss()->why.find("`reset`") != std::string::npos);
  hangs.connect();
  hangs.check_timeouts(hangs.now + 1.9);
  EXPECT(!hangs.loss());
  hangs.check_timeouts(hangs.now + 2.1);
  EXPECT(hangs.loss());
}

void resets_wait_for_a_stop() {
  Talk talk;
  talk.connect();
  talk.sink.controls.clear();
  talk.hold_resets(true);
  talk.add_request({Request::Kind::reset}, talk.now);
  talk.add_request({Request::Kind::arm}, talk.now);
  talk.now += 1.9;
  talk.record_tick(talk.now);
  talk.send();
  talk.now += 0.2;
  talk.send();
  talk.handle_message(nullptr, 0, talk.now);
  talk.check_timeouts(talk.now);
  EXPECT(!talk.loss() && talk.sent<wire::Renew>().size() == 1);
  EXPECT(talk.sent<wire::Reset>().empty() && talk.sent<wire::Arm>().empty());
  talk.hold_resets(false);
  talk.send();
  EXPECT(talk.sent<wire::Reset>().size() == 1 && talk.sent<wire::Arm>().size() == 1);
  EXPECT(std::holds_alternative<wire::Arm>(talk.sink.controls.back()));
}

void what_cannot_be_read_is_told() {
  Talk talk;
  talk.connect();
  talk.events.clear();
  const std::uint8_t bytes[] = {0x81, 0xA2, 'i', 'd', 7};
  talk.handle_message(bytes, sizeof bytes, talk.now);
  EXPECT(talk.events.size() == 1 && talk.events[0].refusal.code == "malformed");
  EXPECT(talk.events[0].refusal.advice == "update the older of game and server");
  for (int i = 0; i < 1000; ++i) talk.handle_message(bytes, sizeof bytes, talk.now);
  EXPECT(talk.events.size() == 1);  // reported once
}

void sessions_that_ended_between_two_ticks_are_not_told() {
  using Kinds = std::vector<Event::Kind>;
  pacinian::client::Mailbox mailbox;
  const auto add = [&](Event::Kind kind) {
    std::vector<Event> some(1);
    some[0].kind = kind;
    mailbox.add_events(some, false);
  };
  const auto take = [&] {
    pacinian::client::SessionStatus view;
    std::vector<Event> events;
    wire::State state;
    mailbox.take_updates(view, events, state);
    Kinds kinds;
    for (const Event& event : events) kinds.push_back(event.kind);
    return kinds;
  };
  add(Event::Kind::connected);
  add(Event::Kind::lost);
  EXPECT(take().empty());
  add(Event::Kind::connected);
  EXPECT(take() == Kinds{Event::Kind::connected});
  for (int i = 0; i < 3; ++i) add(Event::Kind::lost), add(Event::Kind::connected);
  EXPECT((take() == Kinds{Event::Kind::lost, Event::Kind::connected}));
}

}  // namespace

int main() {
  a_session_begins();
  only_ticks_renew();
  an_old_tick_does_not_renew_a_new_session();
  another_version_says_which_side_to_update();
  nothing_resumes();
  ends_of_sound_before_arm_are_forgotten();
  silence_of_the_server_is_a_loss();
  resets_wait_for_a_stop();
  what_cannot_be_read_is_told();
  sessions_that_ended_between_two_ticks_are_not_told();
  return check::result();
}
