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

/// Sends emergency stops in a thread, without a session or worker. On the server's machine a stop is a datagram; if that
/// is not confirmed in half of the time, and elsewhere, it goes through a connection of its own. Repeats the attempt until
/// the server has confirmed the stop, or the time is over.
class EmergencyStop {
 public:
  /// done: called by that thread with the reason for a failure, or with ""; may call `stop`.
  EmergencyStop(const Options& options, std::function<void(const std::string&)> done)
      : options_(options), done_(std::move(done)) {}
  ~EmergencyStop();

  /// Silences the array at once. May be called from any thread; does not block.
  void stop();

  /// Stores a connection for the case that the connection file can no longer be read.
  void remember(const ConnectionFile& connection);

  /// Returns whether a stop is not yet confirmed.
  bool busy() const { return busy_.load(); }

 private:
  void run();
  std::string send();
  bool is_confirmed_without_connection();
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
