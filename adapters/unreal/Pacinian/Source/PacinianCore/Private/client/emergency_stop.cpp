#include "emergency_stop.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "pacinian/wire/codec.h"
#include "pacinian/wire/control.h"
#include "pacinian/wire/writer.h"
#include "stop_datagram.h"
#include "transport.h"

namespace pacinian::client {

namespace {

constexpr double attempt_pause = 0.05;        // [s] between two attempts, and between two checks whether to hurry
constexpr double max_hurried_attempt = 0.25;  // [s] that an attempt may still take then

}  // namespace

EmergencyStop::~EmergencyStop() {
  hurries_.store(true);
  {
    const std::lock_guard<std::mutex> guard(lock_);
    quits_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void EmergencyStop::stop() {
  const std::lock_guard<std::mutex> guard(lock_);
  ++wanted_;
  busy_.store(true);
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  changed_.notify_one();
}

void EmergencyStop::run() {
  std::unique_lock<std::mutex> guard(lock_);
  while (true) {
    changed_.wait(guard, [this] { return wanted_ > 0 || quits_; });
    if (wanted_ == 0) return;
    wanted_ = 0;
    guard.unlock();
    const std::string problem = send();
    guard.lock();
    if (wanted_ > 0) continue;
    busy_.store(false);
    guard.unlock();
    done_(problem);  // which may call `stop`
    guard.lock();
  }
}

void EmergencyStop::remember(const ConnectionFile& connection) {
  const std::lock_guard<std::mutex> guard(lock_);
  remembered_ = connection;
}

bool EmergencyStop::find(ConnectionFile& found, std::string& problem) {
  if (found.read(options_.connection_path, problem)) return true;
  const std::lock_guard<std::mutex> guard(lock_);
  found = remembered_;
  return !found.control.empty();
}

std::string EmergencyStop::send() {
  const double end = options_.clock() + options_.timeout;
  if (is_confirmed_without_connection()) return "";
  while (true) {
    std::string problem = attempt(end);
    const bool over = hurries_.load() || options_.clock() + attempt_pause >= end;
    if (problem.empty() || over) return problem;
    std::this_thread::sleep_for(std::chrono::duration<double>(attempt_pause));
  }
}

bool EmergencyStop::is_confirmed_without_connection() {
  ConnectionFile connection;
  std::string problem;
  if (!find(connection, problem) || connection.stop.empty()) return false;
  const std::string& secret = connection.token.empty() ? connection.secret_key : connection.token;
  return request_stop(connection.stop, secret, options_.clock() + 0.5 * options_.timeout, options_.clock, hurries_);
}

std::string EmergencyStop::attempt(double end) {
  ConnectionFile connection;
  ConnectionFailure loss;
  std::unique_ptr<Transport> transport;
  if (find(connection, loss.why)) transport = connect(connection, false, loss);
  if (!transport) return loss.why;
  wire::Stop stop;
  stop.id = 1;
  wire::Writer writer;
  writer.put(stop);
  wire::AnyReply reply;
  wire::WireError wrong;
  wire::Bytes message;
  bool sent = false;
  for (double left = end - options_.clock(); left > 0.0; left = end - options_.clock()) {
    sent = sent || transport->send(Channel::control, writer.data(), writer.size());
    transport->wait(std::min(left, attempt_pause), nullptr);
    while (transport->receive(Channel::control, message)) {
      if (!wire::decode_reply(message.data(), message.size(), reply, wrong)) continue;
      if (const auto* done = std::get_if<wire::Ok>(&reply); done && done->id == stop.id) return "";
      if (const auto* error = std::get_if<wire::Error>(&reply)) return error->message;
    }
    const End ended = transport->ended();
    if (ended.how != Ending::none) return explain(ended.how, connection.at(ended.where), false).why;
    if (hurries_.load()) end = std::min(end, options_.clock() + max_hurried_attempt);
  }
  return "the server at " + connection.control + " has not confirmed the stop in time";
}

}  // namespace pacinian::client
