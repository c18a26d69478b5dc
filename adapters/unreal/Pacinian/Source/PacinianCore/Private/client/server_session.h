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
#include "timing.h"
#include "worker_messages.h"

namespace pacinian::client {

/// One session after another, from hello to bye: what is lost with one is not taken up again by the next.
///
/// Pure: it is told what has come and the time [s], and says what is to be sent and what has happened.
class ServerSession {
 public:
  static constexpr double share = 0.1;    ///< of the lease between two renewals
  static constexpr double change = 12.0;  ///< [s] that another solver or backend may take to be ready

  /// timeout: of an answer [s].
  ServerSession(wire::Hello hello, double timeout) : hello_(std::move(hello)), timeout_(timeout) {}

  void begin(double now);
  void end();
  bool leaving() const { return phase_ == Phase::leaving; }
  bool connected() const { return phase_ == Phase::connected; }
  /// Whether the server has said welcome.
  bool begun() const { return phase_ != Phase::none && phase_ != Phase::greeting; }

  void ask(Request request, double now);
  /// The game's last tick. Only after another one is the lease renewed again.
  void tick(double time) { ticked_ = time; }
  double ticked() const { return ticked_; }
  /// Whether a renewal is due that a tick would let go.
  bool wants_tick(double now) const;
  /// Resets wait while an emergency stop is on its own way.
  void hold_resets(bool hold) { holds_ = hold; }

  void speak(double now, MessageSink& outlet);
  /// Sends what waits; true if nothing is left.
  bool flush(Outbox& outbox, double now, MessageSink& outlet);
  void bye(MessageSink& outlet);
  /// A message or state that cannot be read: told once in a session.
  void unreadable(const std::string& problem);
  void hear(const std::uint8_t* data, std::size_t size, double now);
  void pass_time(double now);
  /// When `speak` or `pass_time` is to be called at the latest.
  double due(double now) const;

  /// Why it is over; null while it is not.
  const ConnectionFailure* loss() const { return lost_ ? &loss_ : nullptr; }
  void lose(ConnectionFailure loss);
  /// To be taken away. forget_ended: ends that were not told yet are of before `arm`.
  std::vector<Event> events;
  bool forget_ended = false;
  bool armed = false, owner = false;
  wire::Welcome welcome;
  std::shared_ptr<const wire::Abilities> abilities;
  Timing timing;

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
    FieldCallback told;
  };
  struct Sent {
    std::int64_t id = 0;
    double at = 0.0;
  };
  template <class Message>
  Ask& add(Ask::Kind kind, Message& message, double now, double timeout);
  std::int64_t number();
  bool renewal_due(double now) const;
  void renew(double now, MessageSink& outlet);
  void answer(wire::AnyReply& reply, double now);
  void answered(Ask& ask, wire::AnyReply& reply, double now);
  void greeted(double now);
  void inquire(double now);
  void refuse(const Refusal& refusal);
  void error(const wire::Error& error, const Ask* ask);
  void renewed(const wire::Renewed& reply, double now);
  void tell(Event::Kind kind, Refusal refusal);

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
