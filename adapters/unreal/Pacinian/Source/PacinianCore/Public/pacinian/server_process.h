#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pacinian/api.h"

namespace pacinian {

/// Starts the server as a child process: `pacinian serve`, as installed or as a standalone folder.
///
/// The server ends with this program, even after a crash. If another server has written the connection file, none is
/// started while the client can connect to that server. Belongs to one thread; only `stop` blocks.
class ServerProcess {
 public:
  struct Options {
    std::string program = "pacinian";  ///< its path, or its name if the system finds it
    std::vector<std::string> arguments;  ///< more arguments of `serve`, such as the path of a configuration
    std::string connection_path;  ///< by default, the path in PACINIAN_CONNECTION, or the place where the server writes it
    std::string log;              ///< a file for the server's output, in a folder that exists; by default, none
  };

  PACINIANCORE_API explicit ServerProcess(Options options);
  PACINIANCORE_API ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Starts the server, unless another one runs. Returns false on failure; see `problem`.
  PACINIANCORE_API bool start();
  /// Restarts the server if it has ended and the client is not connected to another one, after a pause of 2 s at first
  /// and of 30 s at most; call it once per frame.
  PACINIANCORE_API void tick(bool connected);
  /// Stops the server, and with it all sound, if this program has started it. Waits this time at most [s], then kills
  /// it.
  PACINIANCORE_API void stop(double max_wait = 5.0);

  /// Returns whether the server was started here, and has not ended.
  PACINIANCORE_API bool runs() const;
  /// Returns why the server does not run; empty if it does, or if the client is connected to another one.
  PACINIANCORE_API const std::string& problem() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> in_;
};

}  // namespace pacinian
