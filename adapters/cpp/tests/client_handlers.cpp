// Tests of handlers that throw, and of what a client that was never started reports. Compiled with exceptions.

#include <chrono>
#include <future>
#include <stdexcept>

#include "client/object_validation.h"
#include "client_check.h"
#include "client_scene.h"
#include "pacinian/client.h"

namespace {

using pacinian::Client;
using pacinian::Refusal;

pacinian::Options nobody() {
  pacinian::Options options;
  options.connection_path = "/nonexistent/connection.json";
  options.timeout = 0.1;
  return options;
}

void a_handler_may_throw() {
  Client client(nobody());
  std::vector<std::string> told;
  client.on.refused = [&](const Refusal& why) {
    told.push_back(why.message);
    throw std::runtime_error("of the game");
  };
  client.put("", scene::point(0.0, 0.0, 0.2, 5.0));
  client.put("\xFF", scene::point(0.0, 0.0, 0.2, 5.0));
  for (int caught = 0; caught < 2; ++caught) {  // the second refusal is told at the next tick
    try {
      client.tick();
      EXPECT(false);
    } catch (const std::runtime_error&) {
      EXPECT(told.size() == static_cast<std::size_t>(caught) + 1);
    }
  }
  client.tick();
  EXPECT(told.size() == 2);
}

void a_stop_that_is_not_confirmed_is_told_without_a_session() {
  Client client(nobody());
  std::promise<std::string> told;
  client.stop([&](const Refusal& why) { told.set_value(why.text()); });
  const std::string text = told.get_future().get();
  EXPECT(text.find("the stop was not confirmed") != std::string::npos);
  EXPECT(text.find("switch the array off") != std::string::npos);
  std::string seen;
  client.on.refused = [&](const Refusal& why) { seen = why.text(); };
  client.tick();
  EXPECT(seen == text);
}

void who_is_told_of_a_stop_may_stop_again() {
  Client client(nobody());
  std::promise<void> again;
  client.stop([&](const Refusal&) { client.stop([&](const Refusal&) { again.set_value(); }); });
  again.get_future().wait();
}

void before_the_first_tick_the_thread_that_calls_first_counts() {
  Client client(nobody());
  std::vector<std::string> codes;
  client.on.refused = [&](const Refusal& why) { codes.push_back(why.code); };
  EXPECT(!client.arm());
  EXPECT(!std::async(std::launch::async, [&] { return client.arm(); }).get());
  client.tick();
  EXPECT((codes == std::vector<std::string>{"session", "thread"}));
}

void a_name_is_text() {
  const std::string character = "\xF0\x9F\x98\x80";  // four bytes
  std::string name;
  for (int i = 0; i < 64; ++i) name += character;
  EXPECT(pacinian::client::is_name(name));
  EXPECT(!pacinian::client::is_name(name + "a"));
  EXPECT(!pacinian::client::is_name(""));
  EXPECT(!pacinian::client::is_name("a\xFF"));
  EXPECT(!pacinian::client::is_name(character.substr(0, 2)));
}

}  // namespace

int main() {
  a_handler_may_throw();
  a_stop_that_is_not_confirmed_is_told_without_a_session();
  who_is_told_of_a_stop_may_stop_again();
  before_the_first_tick_the_thread_that_calls_first_counts();
  a_name_is_text();
  return check::result();
}
