#include "pacinian/server_process.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <thread>
#include <utility>

#include "child.h"
#include "connection_file.h"
#include "pacinian/client/options.h"
#include "system.h"

namespace pacinian {

namespace {

constexpr double first_pause = 2.0, longest_pause = 30.0;  // [s] between two starts
constexpr double reset_time = 10.0;  // [s] of running, after which the first pause applies again
constexpr std::chrono::milliseconds poll_interval{10};  // between two checks whether the server has ended
constexpr std::streamoff log_tail = 2000;  // [bytes] that are read of a log
constexpr int killed = -9;  // exit code of a child that SIGKILL ended

/// Returns the last line of a log that reports an error; empty if there is none.
std::string last_error(const std::string& path) {
  std::ifstream file = client::open_file(path);
  file.seekg(0, std::ios::end);
  file.seekg(std::max<std::streamoff>(0, file.tellg() - log_tail));
  std::string line, last;
  while (std::getline(file, line))
    if (line.find("rror") != std::string::npos) last = line;  // error or Error
  return last;
}

}  // namespace

struct ServerProcess::Impl {
  explicit Impl(Options given) : options(std::move(given)) {}

  bool begin(double now) {
    std::vector<std::string> command = {options.program, "serve", "--until-eof"};
    if (!options.connection_path.empty())
      command.insert(command.end(), {"--connection", options.connection_path});
    command.insert(command.end(), options.arguments.begin(), options.arguments.end());
    problem.clear();
    child = client::Child::start(command, options.log, problem);
    started = now;
    schedule_start(now);
    return child != nullptr;
  }

  /// Schedules the next start, after a longer pause each time.
  void schedule_start(double now) {
    due = now + pause;
    pause = std::min(2.0 * pause, longest_pause);
  }

  void note_end(double now) {
    const std::string error = options.log.empty() ? "" : last_error(options.log);
    problem = child->code() == killed ? "the server was killed (signal 9)"
                                      : "the server has ended, with exit code " + std::to_string(child->code());
    problem += error.empty() ? "" : ": " + error;
    child.reset();
    schedule_start(now);
  }

  const Options options;
  std::unique_ptr<client::Child> child;
  std::string problem;
  bool wanted = false;
  double started = 0.0, due = 0.0, pause = first_pause;
};

ServerProcess::ServerProcess(Options options) : in_(std::make_unique<Impl>(std::move(options))) {}

ServerProcess::~ServerProcess() { stop(); }

bool ServerProcess::start() {
  Impl& in = *in_;
  if (runs()) return true;
  if (client::is_text(in.options.connection_path))
    return in.problem = "the connection is given as text, so its server runs elsewhere and none is started here: give the"
                        " path of a connection file",
           false;
  const double now = steady_clock();
  in.wanted = true;
  in.pause = first_pause;
  in.problem.clear();
  client::ConnectionFile other;
  std::string why;
  if (!other.read(in.options.connection_path, why)) return in.begin(now);
  in.schedule_start(now);
  return true;
}

void ServerProcess::tick(bool connected) {
  Impl& in = *in_;
  const double now = steady_clock();
  if (!in.wanted) return;
  if (in.child && !in.child->runs()) in.note_end(now);
  if (connected) in.problem.clear();
  if (connected || (in.child && now > in.started + reset_time)) in.pause = first_pause;
  if (connected && !in.child) in.schedule_start(now);
  if (!connected && !in.child && now >= in.due) in.begin(now);
}

void ServerProcess::stop(double max_wait) {
  in_->wanted = false;
  if (!in_->child) return;
  in_->child->close_input();
  for (const double end = steady_clock() + max_wait; in_->child->runs(); std::this_thread::sleep_for(poll_interval))
    if (steady_clock() > end) in_->child->kill();
  in_->child.reset();
}

bool ServerProcess::runs() const { return in_->child && in_->child->runs(); }

const std::string& ServerProcess::problem() const { return in_->problem; }

}  // namespace pacinian
