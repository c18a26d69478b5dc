#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "connection_failure.h"
#include "outbox.h"
#include "pacinian/wire/codec.h"
#include "pacinian/wire/writer.h"
#include "server_clock.h"
#include "worker_messages.h"

namespace pacinian::client {

/// Runs one session after another, from hello to bye. Nothing of a lost session continues in the next.
///
/// Does no input or output and does not read a clock: received bytes and times [s] are arguments. Messages go to a
/// sink, and events to `events`.
class ServerSession {
 public:
  static constexpr double renewal_share = 0.125;  ///< interval between renewals, as a fraction of the lease
  static constexpr double change = 12.0;  ///< [s] longest time to open a solver or backend

  /// timeout: for an answer [s].
  ServerSession(wire::Hello hello, double timeout) : hello_(std::move(hello)), timeout_(timeout) {}

  void begin(double now);
  void end();
  bool leaving() const { return phase_ == Phase::leaving; }
  bool connected() const { return phase_ == Phase::connected; }
  /// Returns whether the server has answered hello with welcome.
  bool begun() const { return phase_ != Phase::none && phase_ != Phase::greeting; }

  void add_request(Request request, double now);
  /// Records the game's last tick. Each renewal of the lease needs a new tick.
  void record_tick(double time) { ticked_ = time; }
  double last_tick() const { return ticked_; }
  /// Returns whether a renewal is due that only waits for a tick.
  bool wants_tick(double now) const;
  /// Delays resets while an emergency stop is not confirmed.
  void hold_resets(bool hold) { holds_ = hold; }

  void send_requests(double now, MessageSink& outlet);
  /// Sends waiting commands. Returns whether none is left.
  bool send_commands(Outbox& outbox, double now, MessageSink& outlet);
  void say_goodbye(MessageSink& outlet);
  /// Reports a message or state that cannot be decoded; once per session.
  void report_unreadable(const std::string& problem);
  void handle_message(const std::uint8_t* data, std::size_t size, double now);
  void check_timeouts(double now);
  /// Returns when `send_requests` or `check_timeouts` must be called at the latest.
  double due(double now) const;

  /// Returns why the session is over; null while it is not.
  const ConnectionFailure* loss() const { return lost_ ? &loss_ : nullptr; }
  void set_lost(ConnectionFailure loss);
  /// The caller takes the events. forget_ended: `ended` events that were not taken are older than `arm`, and are
  /// dropped.
  std::vector<Event> events;
  bool forget_ended = false;
  bool armed = false, owner = false;
  wire::Welcome welcome;
  std::shared_ptr<const wire::Abilities> abilities;
  ServerClock server_clock;

 private:
  enum class Phase : std::uint8_t { none, greeting, asking, connected, leaving };
  struct Ask {
    enum class Kind : std::uint8_t { hello, capabilities, request, field };
    Kind kind;
    Request::Kind of;
    const char* name;
    std::int64_t id;
    double timeout, deadline;
    wire::Writer message;
    bool sent;
    FieldCallback callback;
  };
  struct Sent {
    std::int64_t id = 0;
    double at = 0.0;
  };
  template <class Message>
  Ask& queue_message(Ask::Kind kind, Message& message, double now, double timeout);
  std::int64_t next_id();
  bool renewal_due(double now) const;
  void renew(double now, MessageSink& outlet);
  void handle_reply(wire::AnyReply& reply, double now);
  void complete_request(Ask& ask, wire::AnyReply& reply, double now);
  void handle_welcome(double now);
  void request_capabilities(double now);
  void reject(const Refusal& refusal);
  void handle_error(const wire::Error& error, const Ask* ask);
  void handle_renewal(const wire::Renewed& reply, double now);
  void add_event(Event::Kind kind, Refusal refusal);

  wire::Hello hello_;
  const double timeout_;
  Phase phase_ = Phase::none;
  bool holds_ = false, lost_ = false, unreadable_ = false;
  ConnectionFailure loss_;
  std::int64_t ids_ = 0, sequence_ = 0;
  double ticked_ = -1e300, renewed_ = -1e300, due_ = 0.0, heard_ = 0.0;
  std::deque<Ask> asks_;
  std::array<Sent, 16> sent_{};
  wire::Renew renew_;
  wire::Writer writer_;
  wire::AnyReply reply_;
};

}  // namespace pacinian::client
