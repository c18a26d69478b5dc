// A ball, and a hand that moves through it. Connects, plays for a while, and prints its measurements as a line of JSON;
// then plays on until it is killed, and prints a line for each stretch.
// Arguments, each optional: connection file, seconds, solver and backend to change to.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <thread>

#include "allocations.h"
#include "hand.h"
#include "pacinian/client.h"

namespace {

namespace wire = pacinian::wire;

constexpr double rate = 90.0;    // [Hz]
constexpr double timeout = 60;  // [s] until the ball is felt
constexpr double height = 0.2;   // [m] of the ball above the array

wire::Volume ball() {
  wire::Volume made;
  made.shape = wire::Sphere{0.03};
  made.pose.position = {0.0, 0.0, height};
  made.radiation_pressure = 20.0;
  return made;
}

/// Returns a quantile of sorted numbers; 0 if there are none.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5)];
}

class Play {
 public:
  Play(pacinian::Options options, std::string solver, std::string backend)
      : client_(std::move(options)), solver_(std::move(solver)), backend_(std::move(backend)) {
    hands_.resize(1);
    calls_.reserve(100'000);
    latencies_.reserve(100'000);
    client_.on.connected = [this] { begin(); };
    client_.on.refused = [](const pacinian::Refusal& why) {
      std::fprintf(stderr, "refused: %s\n", why.text().c_str());
    };
    client_.on.ended = client_.on.refused;
    client_.on.state_changed = [this](const wire::State& state) { look(state); };
    client_.start();
  }

  /// Plays for this time, or until the ball is felt. Returns false if it was not felt in time.
  bool frames(double seconds, bool until_felt = false) {
    const double end = client_.now() + seconds;
    for (double due = client_.now(); due < end && !(until_felt && felt_); due += 1.0 / rate) {
      due = std::max(due, client_.now() - 1.0 / rate);
      std::this_thread::sleep_for(std::chrono::duration<double>(due - client_.now()));
      frame();
    }
    return felt_;
  }

  void change() {
    wire::Select choice;
    if (!solver_.empty()) choice.solver.emplace().name = solver_;
    if (!backend_.empty()) choice.backend.emplace().name = backend_;
    client_.select(std::move(choice));
  }

  /// Starts to count frames and allocations.
  void count() { frames_ = 0, std::copy_n(example::allocations, 3, before_); }

  void tell() {
    const double frames = std::max(1, frames_);
    const auto allocated = [&](example::Thread thread) {
      return static_cast<double>(example::allocations[thread] - before_[thread]) / frames;
    };
    const double game = allocated(example::game), worker = allocated(example::worker);
    std::sort(calls_.begin(), calls_.end());
    std::sort(latencies_.begin(), latencies_.end());
    const pacinian::RoundTrips round_trips = client_.round_trips();
    std::printf(
        "{\"round_trip_p50\": %.6f, \"round_trip_p99\": %.6f, \"hand_to_emitted_p50\": %.6f, "
        "\"hand_to_emitted_p99\": %.6f, \"hands\": %zu, \"allocations_game\": %.4f, "
        "\"allocations_worker\": %.4f, \"call_p99\": %.6f, \"call_longest\": %.6f, \"frames\": %d, "
        "\"armed\": %s, \"points\": %zu, \"at\": [%.4f, %.4f, %.4f], \"hand_x\": %.4f, \"solvers\": [%s], "
        "\"backends\": [%s]}\n",
        round_trips.median, round_trips.p99, quantile(latencies_, 0.5), quantile(latencies_, 0.99),
        latencies_.size(), game, worker, quantile(calls_, 0.99), quantile(calls_, 1.0), frames_,
        client_.armed() ? "true" : "false", points_, at_[0], at_[1], at_[2], x_, solvers_.c_str(),
        backends_.c_str());
    std::fflush(stdout);
  }

 private:
  void begin() {
    client_.put("ball", ball());
    client_.arm(true);
  }

  void frame() {
    ++frames_;
    x_ = 0.02 * std::sin(2.0 * std::acos(-1.0) * 0.5 * client_.now());
    example::place_hand(hands_[0], static_cast<float>(x_), 0.0F, static_cast<float>(height));
    wire::Pose pose;
    pose.position = {0.0, 0.25 * x_, height};
    timed([this] { client_.tick(); });
    timed([this] { client_.hands(hands_); });
    timed([&] { client_.move("ball", pose); });
  }

  template <class Act>
  void timed(Act act) {
    const double begin = client_.now();
    act();
    if (calls_.size() < calls_.capacity()) calls_.push_back(client_.now() - begin);
  }

  /// Measures what the server reports that it emits.
  void look(const wire::State& state) {
    felt_ = felt_ || state.output == wire::Output::sounding;
    if (state.output == wire::Output::sounding) {
      note(solvers_, state.solver);
      note(backends_, state.backend);
    }
    if (state.output == wire::Output::sounding && !state.points.empty()) {
      points_ = state.points.size() / 12;
      for (std::size_t i = 0; i < 3; ++i) at_[i] = wire::float_at(state.points, i);
    }
    for (std::size_t row = 0; row + 32 <= state.inputs.size(); row += 32) {
      double values[4];  // sequence, the client's time, received, emitted
      std::memcpy(values, state.inputs.data() + row, sizeof values);
      if (latencies_.size() < latencies_.capacity())
        latencies_.push_back(values[3] - values[1] - client_.offset());
    }
  }

  static void note(std::string& names, const std::string& name) {
    if (names.find('"' + name + '"') != std::string::npos) return;
    names += (names.empty() ? "\"" : ", \"") + name + '"';
  }

  pacinian::Client client_;
  std::string solver_, backend_, solvers_, backends_;
  std::vector<wire::HandFrame> hands_;
  std::vector<double> calls_, latencies_;
  std::size_t points_ = 0;
  double at_[3] = {}, x_ = 0.0;
  bool felt_ = false;
  int frames_ = 0;
  long before_[3] = {};
};

}  // namespace

int main(int count, char** arguments) {
  const auto argument = [&](int i, const char* otherwise) {
    return std::string(count > i ? arguments[i] : otherwise);
  };
  example::thread = example::game;
  pacinian::Options options;
  options.name = "ball";
  options.connection_path = argument(1, "");
  options.clock = [] {
    if (example::thread == example::others) example::thread = example::worker;
    return pacinian::steady_clock();
  };
  const double seconds = std::atof(argument(2, "10").c_str());
  Play play(std::move(options), argument(3, "gs-pat"), argument(4, ""));
  if (!play.frames(timeout, true)) return 1;
  play.frames(0.3 * seconds);
  play.change();
  play.frames(0.3 * seconds);
  for (;;) {
    play.count();
    play.frames(0.4 * seconds);
    play.tell();
  }
}
