#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pacinian/api.h"

namespace pacinian {

/// The server, if this program is to start it: `pacinian serve`, as installed or as a standalone folder.
///
/// It ends with this program, however that ends. If another server has written the connection file, none is started as
/// long as the client can connect to that one. Belongs to one thread; only `stop` waits.
class ServerProcess {
 public:
  struct Options {
    std::string program = "pacinian";  ///< its path, or its name if the system finds it
    std::vector<std::string> arguments;  ///< more than `serve`, such as the path of a configuration
    std::string connection_path;  ///< unless given, that of PACINIAN_CONNECTION, or where the server writes it
    std::string log;              ///< a file for what the server says; none unless given
  };

  PACINIANCORE_API explicit ServerProcess(Options options);
  PACINIANCORE_API ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Starts it, unless another server runs. False if it cannot be started: see `problem`.
  PACINIANCORE_API bool start();
  /// Once in each of the game's frames: starts it again, after 2 s at first and 30 s at most, if it has ended and the
  /// client is not connected to another one.
  PACINIANCORE_API void tick(bool connected);
  /// Ends it, and with it all sound, if this program has started it. Takes at most so long [s], and then kills it.
  PACINIANCORE_API void stop(double patience = 5.0);

  /// Whether it was started here, and has not ended.
  PACINIANCORE_API bool runs() const;
  /// Why it does not run; empty if it does, or the client is connected to another one.
  PACINIANCORE_API const std::string& problem() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> in_;
};

}  // namespace pacinian
