#ifndef _WIN32

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "child.h"

extern char** environ;

namespace pacinian::client {

namespace {

constexpr char nothing[] = "/dev/null";
constexpr int unknown = -1;

/// Opens a pipe that child processes do not inherit: it stays open as long as any process has its end for writing.
bool open_pipe(int (&ends)[2]) {
  if (::pipe(ends) != 0) return false;
  for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  return true;
}

}  // namespace

struct Child::Handles {
  pid_t pid;
  int input;
};

Child::Child(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}

Child::~Child() { close_input(); }

std::unique_ptr<Child> Child::start(const std::vector<std::string>& command, const std::string& log,
                                    std::string& problem) {
  const int errors = ::open(log.empty() ? nothing : log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (errors < 0) return problem = describe_log_failure(log, std::strerror(errno)), nullptr;
  int ends[2];
  if (!open_pipe(ends)) {
    problem = describe_program_failure(command[0], std::strerror(errno));
    ::close(errors);
    return nullptr;
  }
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, nothing, O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, errors, STDERR_FILENO);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t all, none;
  ::sigfillset(&all);
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C in the terminal ends the game, and then the game ends the child
  ::posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t pid = 0;
  const int error = ::posix_spawnp(&pid, words[0], &files, &attributes, words.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  ::close(ends[0]);
  ::close(errors);
  if (error == 0)
    return std::unique_ptr<Child>(new Child(std::make_unique<Handles>(Handles{pid, ends[1]})));
  ::close(ends[1]);
  return problem = describe_program_failure(command[0], std::strerror(error)), nullptr;
}

bool Child::runs() {
  if (ended_) return false;
  int status = 0;
  const pid_t found = ::waitpid(handles_->pid, &status, WNOHANG);
  if (found == 0 || (found < 0 && errno == EINTR)) return true;
  ended_ = true;
  code_ = found < 0 ? unknown : WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  return false;
}

void Child::close_input() {
  if (handles_->input >= 0) ::close(std::exchange(handles_->input, -1));
}

void Child::kill() {
  if (runs()) ::kill(handles_->pid, SIGKILL);
}

}  // namespace pacinian::client

#endif
