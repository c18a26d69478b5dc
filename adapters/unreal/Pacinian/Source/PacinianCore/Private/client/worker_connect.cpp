#include <cmath>

#include "pacinian/wire/protocol.h"
#include "worker.h"

namespace pacinian::client {

namespace {

constexpr double farewell = 0.2;  // [s] that a bye may take

}  // namespace

wire::Hello Worker::introduce(const Options& options) {
  wire::Hello hello;
  hello.protocol = {wire::MAJOR, wire::MINOR};
  hello.client = options.name;
  hello.version = options.version;
  hello.scene = options.scene;
  hello.lease = options.lease;
  return hello;
}

void Worker::connect(double now) {
  Loss loss;
  if (open(loss)) {
    dialogue_.begin(now);
    return;
  }
  disconnect();
  attempts_.failed(loss, options_.clock());
}

bool Worker::open(Loss& loss) {
  open_ = true;
  held_ = never;
  if (!connection_.read(options_.connection_path, loss.why)) return false;
  states_.open(context_, ZMQ_SUB);
  states_.set(ZMQ_SUBSCRIBE, wire::State::tag);
  return control_.open(context_, connection_, connection_.control, true, loss) &&
         command_.open(context_, connection_, connection_.command, false, loss) &&
         prepare(states_, connection_, connection_.state, loss);
}

void Worker::disconnect() {
  control_.close();
  command_.close();
  states_.close();
  outbox_->forget();  // nothing old reaches the next server
  open_ = false;
}

void Worker::leave() {
  if (!open_) return;
  dialogue_.bye(*this);
  const double end = options_.clock() + farewell;
  double left = farewell;
  while (dialogue_.leaving() && !dialogue_.loss() && left > 0.0) {
    zmq_pollitem_t items[] = {{control_.socket(), 0, ZMQ_POLLIN, 0},
                              {control_.monitor(), 0, ZMQ_POLLIN, 0}};
    zmq_poll(items, 2, static_cast<long>(std::ceil(1e3 * left)));
    hear();
    left = end - options_.clock();
  }
  disconnect();
}

}  // namespace pacinian::client
