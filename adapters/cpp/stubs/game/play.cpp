// Plays a game without the engine at 90 frames a second, controlled by standard input.
//   play <connection file> [unarmed] [again] [handless] [dedicated]

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <sstream>
#include <thread>

#include "level.h"

IModuleInterface* StubModulePacinian();
IModuleInterface* StubModulePacinianCore();

namespace {

using Clock = std::chrono::steady_clock;

double frame = 1.0 / 90.0;  // [s]

double seconds(Clock::duration given) { return std::chrono::duration<double>(given).count(); }

/// Reads a line if one is available, otherwise returns false. ended: set when no more lines will come.
bool line(std::string& found, bool& ended) {
  static std::string buffer;
  pollfd input{0, POLLIN, 0};
  while (poll(&input, 1, 0) > 0 && !ended) {
    char bytes[4096];
    const ssize_t count = read(0, bytes, sizeof bytes);
    if (count <= 0) ended = true;
    if (count > 0) buffer.append(bytes, static_cast<std::size_t>(count));
  }
  const std::size_t end = buffer.find('\n');
  if (end == std::string::npos) return false;
  found = buffer.substr(0, end);
  buffer.erase(0, end + 1);
  return true;
}

void report(const char* what) {
  std::printf("{\"did\": \"%s\"}\n", what);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) return 2;
  std::string more;
  for (int i = 2; i < count; ++i) more += words[i];
  const std::unique_ptr<IModuleInterface> core(StubModulePacinianCore()), module(StubModulePacinian());
  UEngine engine;
  GEngine = &engine;
  core->StartupModule();
  module->StartupModule();
  auto level = std::make_unique<Level>(words[1], more);
  Clock::time_point due = Clock::now(), before = due;
  for (bool ended = false; !ended;) {
    std::string text;
    while (line(text, ended)) {
      std::istringstream rest(text);
      std::string word;
      rest >> word;
      if (word == "end" || word == "exit" || word == "unload") {
        if (word == "exit") FCoreDelegates::OnEnginePreExit.Broadcast();
        if (word == "unload") module->ShutdownModule();
        level->end(EEndPlayReason::EndPlayInEditor);
        report(word.c_str());
        return 0;
      }
      if (word == "level") {
        level = std::make_unique<Level>(words[1], more);
        report("level");
      } else if (word == "frame") {
        rest >> frame;
        report("frame");
      } else if (word == "freeze") {
        pollfd input{0, POLLIN, 0};
        poll(&input, 1, -1);  // until a command arrives
        report("freeze");
      } else {
        level->act(word, rest);
      }
    }
    const auto began = Clock::now();
    level->tick(static_cast<float>(seconds(began - before)));
    before = began;
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(frame)), Clock::now());
    std::this_thread::sleep_until(due);
  }
  return 0;
}
