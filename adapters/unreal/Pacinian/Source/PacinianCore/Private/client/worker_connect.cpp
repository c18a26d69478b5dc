#include "pacinian/wire/protocol.h"
#include "worker.h"

namespace pacinian::client {

namespace {

constexpr double max_farewell = 0.2;  // [s] that a bye may take

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
  if (connection_.read(options_.connection_path, loss.why)) transport_ = client::connect(connection_, true, loss);
  if (transport_) return session_.begin(now);
  disconnect();
  backoff_.record_failure(loss, options_.clock(), ReconnectBackoff::unasked);
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
