// A game that executes commands from standard input, one per line, and prints events as lines of JSON.
// Arguments, all but the first optional: connection file (-: the default), lease [s] (0: the server's), time to live of
// a command [s], timeout of an answer [s].

#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <sstream>
#include <thread>

#include "client_driver.h"
#include "client_scene.h"

namespace {

using driver::say;
using pacinian::Client;
using pacinian::Refusal;
namespace wire = pacinian::wire;

constexpr double frame = 1.0 / 90.0;  // [s]
constexpr const char* statuses[] = {"Stopped", "Connecting", "Connected", "Refused"};

void event(const char* what, const Refusal& why) {
  say({{"event", what}, {"code", why.code}, {"message", why.message}, {"advice", why.advice},
       {"path", why.path}});
}

void touched(const char* what, const wire::TouchState& touch) {
  say({{"event", what}, {"object", touch.object}, {"hand", touch.hand}, {"strength", touch.strength}});
}

/// A clock that can block the client's own thread.
class Clock {
 public:
  double now() {
    if (std::this_thread::get_id() != game_) {
      std::unique_lock<std::mutex> guard(lock_);
      if (worker_ == std::thread::id()) worker_ = std::this_thread::get_id();  // the first that reads the clock
      if (worker_ == std::this_thread::get_id() && held_) {
        stands_ = true;
        changed_.notify_all();
        changed_.wait(guard, [this] { return !held_; });
        stands_ = false;
      }
    }
    return pacinian::steady_clock();
  }

  /// Returns when that thread is blocked.
  void hold() {
    std::unique_lock<std::mutex> guard(lock_);
    held_ = true;
    changed_.wait(guard, [this] { return stands_; });
  }

  void release() {
    const std::lock_guard<std::mutex> guard(lock_);
    held_ = false;
    changed_.notify_all();
  }

 private:
  const std::thread::id game_ = std::this_thread::get_id();
  std::thread::id worker_;
  std::mutex lock_;
  std::condition_variable changed_;
  bool held_ = false, stands_ = false;
};

Clock clock_of_both;

class Game {
 public:
  explicit Game(pacinian::Options options) : client_(std::move(options)) {
    client_.on.connected = [] { event("connected", {}); };
    client_.on.lost = [](const std::string& why) { event("lost", {"", why, "", ""}); };
    client_.on.ended = [](const Refusal& why) { event("ended", why); };
    client_.on.refused = [](const Refusal& why) { event("refused", why); };
    client_.on.touch_began = [](const wire::TouchState& touch) { touched("touch", touch); };
    client_.on.touch_moved = [this](const wire::TouchState& touch) { moved_ = touch; };
    client_.on.touch_ended = [](const wire::TouchState& touch) { touched("left", touch); };
    client_.on.stood_still = [](const pacinian::Standstill& still) {
      say({{"event", "stood still"}, {"seconds", still.seconds}, {"whole", still.whole}, {"text", still.text()}});
    };
  }

  /// Plays one frame.
  void step() {
    if (!ticks_) return;
    client_.tick();
    if (!waves_) return;
    hands_.resize(1);
    const double phase = 3.14159265358979 * client_.now();
    scene::place_hand(hands_[0], static_cast<float>(0.02 * std::sin(phase)), 0.0F, 0.2F);
    client_.hands(hands_);
  }

  /// Executes a command. Returns false at the end.
  bool obey(const std::string& line) {
    std::istringstream words(line);
    std::string what, name;
    words >> what >> name;
    double n[4] = {};
    for (double& number : n) words >> number;
    const double number = std::atof(name.c_str());
    if (what == "status") return tell(), true;
    if (what == "felt") return tell(name, client_.felt(name)), true;
    if (what == "end") return false;
    bool done = true;
    if (what == "put") {
      done = client_.put(name, scene::point(n[0], n[1], n[2], n[3]));
    } else if (what == "elsewhere") {
      std::thread([&] { done = client_.put(name, scene::point(n[0], n[1], n[2], n[3])); }).join();
    } else if (what == "ball") {
      done = client_.put(name, scene::ball(n[0], n[1]));
    } else if (what == "heavy") {
      wire::Object object = scene::rain(static_cast<int>(n[0]));
      done = client_.put(name, std::move(object));
    } else if (what == "move") {
      done = client_.move(name, scene::pose(n[0], n[1], n[2]));
    } else if (what == "envelope") {
      wire::Sine sine;
      sine.frequency = n[0];
      done = client_.envelope(name, sine);
    } else if (what == "quiet") {
      wire::Zone zone;
      zone.position = {n[0], n[1], n[2]};
      zone.pressure = n[3];
      done = client_.quiet({zone});
    } else if (what == "field") {
      const auto point = scene::floats(n);
      done = client_.field({point}, felt);
    } else if (what == "solver" || what == "backend" || what == "intensity") {
      wire::Select choice;
      if (what == "solver") choice.solver.emplace().name = name;
      if (what == "backend") choice.backend.emplace().name = name;
      if (what == "intensity") choice.intensity = number;
      done = client_.select(std::move(choice));
    } else {
      done = simple(what, name);
    }
    say({{"did", what}, {"done", done}, {"time", client_.now()}});
    return true;
  }

 private:
  bool simple(const std::string& what, const std::string& name) {
    if (what == "start") client_.start();
    if (what == "stop") client_.stop();
    if (what == "dispose") client_.close();
    if (what == "hold") clock_of_both.hold();
    if (what == "release") clock_of_both.release();
    if (what == "wave") waves_ = name == "on";
    if (what == "lose") waves_ = false, hands_.clear();
    if (what == "lose") return client_.hands(hands_);
    if (what == "freeze") freeze();
    if (what == "tick") ticks_ = name == "on";
    if (what == "remove") return client_.remove(name);
    if (what == "clear") return client_.clear();
    if (what == "arm") return client_.arm(name == "take", name != "once");
    if (what == "disarm") return client_.disarm();
    return what != "reset" || client_.reset();
  }

  /// Blocks the game's thread until more input arrives.
  static void freeze() {
    pollfd input = {STDIN_FILENO, POLLIN, 0};
    ::poll(&input, 1, -1);
  }

  static void felt(const std::vector<std::complex<float>>& pressures) {
    say({{"field", pressures.empty() ? std::int64_t{-1} : static_cast<std::int64_t>(pressures.size())}});
  }

  static void tell(const std::string& name, const pacinian::RegionFelt& felt) {
    const auto figure = [&](float value) { return felt.known() ? static_cast<double>(value) : 0.0; };
    say({{"region", name}, {"known", felt.known()}, {"force", figure(felt.force)}, {"rms", figure(felt.rms)},
         {"holes", figure(felt.holes)}, {"spill", figure(felt.spill)}});
  }

  void tell() {
    static const wire::State none;
    const bool some = client_.state() != nullptr;
    const wire::State& state = some ? *client_.state() : none;
    const auto count = [](bool there, std::size_t n) { return there ? static_cast<std::int64_t>(n) : -1; };
    const wire::Abilities* abilities = client_.capabilities();
    const auto output = words(state.output)[static_cast<std::size_t>(state.output)];
    say({{"status", statuses[static_cast<int>(client_.status())]},
         {"problem", client_.problem()}, {"armed", client_.armed()}, {"owner", client_.owner()},
         {"lease", client_.lease()}, {"latency", client_.latency()}, {"scene", client_.scene()},
         {"server", client_.server()}, {"offset", client_.offset()},
         {"time", client_.now()}, {"solvers", count(abilities, abilities ? abilities->solvers.size() : 0)},
         {"output", some ? std::string(output) : ""}, {"objects", count(some, state.objects.size())},
         {"cause", client_.silence().cause}, {"why", client_.silence().text}, {"touched", moved_.object},
         {"strength", moved_.strength}, {"height", moved_.position[2]},
         {"solver", state.solver}, {"backend", state.backend}, {"intensity", some ? state.intensity : -1.0},
         {"points", count(some, state.points.size() / 12)},
         {"hands", count(some, state.hands.size() / 312)}, {"sequence", some ? state.sequence : -1},
         {"age", some ? client_.age(state) : -1.0}});
  }

  Client client_;
  std::vector<wire::HandFrame> hands_;
  wire::TouchState moved_;
  bool ticks_ = true, waves_ = false;
};

/// Adds the input that arrives within a time [s]. Returns false at the end of the input.
bool read(std::string& waiting, double seconds) {
  pollfd input = {STDIN_FILENO, POLLIN, 0};
  if (::poll(&input, 1, static_cast<int>(1e3 * seconds)) <= 0) return true;
  char buffer[4096];
  const ssize_t got = ::read(STDIN_FILENO, buffer, sizeof buffer);
  if (got > 0) waiting.append(buffer, static_cast<std::size_t>(got));
  return got > 0;
}

}  // namespace

int main(int count, char** arguments) {
  pacinian::Options options;
  options.name = "driver";
  if (count > 1 && std::string(arguments[1]) != "-") options.connection_path = arguments[1];
  if (count > 2 && std::atof(arguments[2]) != 0.0) options.lease = std::atof(arguments[2]);
  if (count > 3) options.life = std::atof(arguments[3]);
  if (count > 4) options.timeout = std::atof(arguments[4]);
  options.clock = [] { return clock_of_both.now(); };
  Game game(std::move(options));
  std::string waiting;
  for (double due = pacinian::steady_clock();;) {
    const double now = pacinian::steady_clock();
    if (now >= due) game.step();
    if (now >= due) due = std::max(due + frame, now);
    if (!read(waiting, std::max(0.0, due - pacinian::steady_clock()))) return 0;
    for (auto end = waiting.find('\n'); end != std::string::npos; end = waiting.find('\n')) {
      if (!game.obey(waiting.substr(0, end))) return 0;
      waiting.erase(0, end + 1);
    }
  }
}
