#pragma once

#include <memory>
#include <string>
#include <vector>

namespace pacinian::client {

/// Why a child process was not started, and what to do.
inline std::string describe_program_failure(const std::string& program, const std::string& why) {
  return program + " cannot be started: " + why + "; install Pacinian, or give the program's full path";
}

inline std::string describe_log_failure(const std::string& log, const std::string& why) {
  return "the log " + log + " cannot be written: " + why + "; create its folder, or give another path";
}

/// A child process. Its standard input is a pipe, which the system closes when this program ends.
class Child {
 public:
  /// Starts a process. command: the program, then its arguments. log: a file for its standard error; none if empty.
  /// Returns null and the problem on failure.
  static std::unique_ptr<Child> start(const std::vector<std::string>& command, const std::string& log,
                                      std::string& problem);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool runs();
  /// Returns the exit code; less than 0: the signal that killed the process, or unknown.
  int code() const { return code_; }
  void close_input();
  void kill();

 private:
  struct Handles;
  explicit Child(std::unique_ptr<Handles> handles);

  std::unique_ptr<Handles> handles_;
  int code_ = 0;
  bool ended_ = false;
};

}  // namespace pacinian::client
