#include <cstdio>

#include "pacinian/wire/protocol.h"
#include "worker.h"

namespace pacinian::client {

namespace {

constexpr double max_farewell = 0.2;  // [s] that a bye may take

/// Returns what is wrong with the options that the server does not see; empty if nothing is.
std::string find_wrong_option(const Options& options) {
  const bool lives = options.life > 0.0;
  if (lives && options.timeout > 0.0) return "";
  char text[80];
  std::snprintf(text, sizeof text, "the option `%s` is %g s: it must be more than 0 s", lives ? "timeout" : "life",
                lives ? options.timeout : options.life);
  return text;
}

}  // namespace

wire::Hello Worker::make_hello(const Options& options) {
  wire::Hello hello;
  hello.protocol = {wire::MAJOR, wire::MINOR};
  hello.client = options.name;
  hello.version = options.version;
  hello.scene = options.scene;
  hello.lease = options.lease;
  return hello;
}

void Worker::connect(double now) {
  ConnectionFailure loss;
  held_ = never;
  loss.why = find_wrong_option(options_);
  loss.refused = !loss.why.empty();
  if (!loss.refused && connection_.read(options_.connection_path, loss.why)) transport_ = client::connect(connection_, true, loss);
  if (transport_) return session_.begin(now);
  disconnect();
  backoff_.record_failure(loss, options_.clock(), ReconnectBackoff::max_pause_without_server);
}

void Worker::disconnect() {
  transport_.reset();
  outbox_->forget();  // no old command reaches the next server
}

void Worker::say_goodbye() {
  if (!transport_) return;
  session_.say_goodbye(*this);
  const double end = options_.clock() + max_farewell;
  double left = max_farewell;
  while (session_.leaving() && !session_.loss() && left > 0.0) {
    transport_->wait(left, nullptr);
    receive_messages();
    left = end - options_.clock();
  }
  disconnect();
}

}  // namespace pacinian::client
