#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "connection_file.h"
#include "pacinian/client/options.h"

namespace pacinian::client {

/// Sends emergency stops on connections of their own, which need no session and no worker, in a thread of its own:
/// again and again, until the server has confirmed it or the time is over.
class EmergencyStop {
 public:
  /// done: called by that thread with what went wrong, or "".
  EmergencyStop(const Options& options, std::function<void(const std::string&)> done)
      : options_(options), done_(std::move(done)) {}
  ~EmergencyStop();

  /// Silence at once. From any thread; does not wait.
  void stop();

  /// How to connect where the connection file cannot be read any more.
  void remember(const ConnectionFile& connection);

  /// Whether one is on its way.
  bool busy() const { return busy_.load(); }

 private:
  void run();
  std::string send();
  std::string attempt(double end);
  bool find(ConnectionFile& found, std::string& problem);

  const Options& options_;
  const std::function<void(const std::string&)> done_;
  std::mutex lock_;
  std::condition_variable changed_;
  ConnectionFile remembered_;
  int wanted_ = 0;
  bool quits_ = false;
  std::atomic<bool> busy_{false}, hurries_{false};
  std::thread thread_;
};

}  // namespace pacinian::client
