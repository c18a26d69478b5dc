#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "message_sink.h"
#include "pacinian/wire/commands.h"

namespace pacinian::client {

using Place = std::array<float, 7>;  ///< x, y, z [m], quaternion x, y, z, w
using Speed = std::array<float, 6>;  ///< [m/s], [rad/s]

/// What waits to be told of one object: that it is there or gone, then where, then how strong.
struct Waiting {
  Stamp put, removed, moved, enveloped;
  bool listed = false;
  wire::Object object;
  Place place{};
  Speed speed{};
  bool moves = false;
  wire::Envelope envelope;
};

/// What is to be sent: of each object only the newest, for as long as it may live. Pure: it is told the time.
///
/// Memory of names that come again is kept, so that moving what is there allocates nothing.
class Outbox {
 public:
  void put(std::string_view name, wire::Object object, Stamp stamp);
  void remove(std::string_view name, Stamp stamp);
  void move(std::string_view name, const Place& place, const Speed* speed, Stamp stamp);
  void envelope(std::string_view name, const wire::Envelope& envelope, Stamp stamp);
  void hands(const std::vector<wire::HandFrame>& hands, Stamp stamp);
  void quiet(const std::vector<wire::Zone>& zones, Stamp stamp);
  void clear(Stamp stamp);

  bool empty() const;
  /// Nothing waits any more.
  void forget();
  /// What is newer goes over into this one, and out of that.
  void take(Outbox& newer);
  /// Sends what is not too old, until there is no room. True if nothing is left.
  bool flush(double now, CommandSender& courier);

 private:
  using Entries = std::map<std::string, Waiting, std::less<>>;
  using Entry = Entries::value_type;

  Entry& at(std::string_view name);
  void drop_overdue(double now);
  bool gather(Stamp Waiting::*kind);
  void sent(Stamp Waiting::*kind);
  bool send_puts(CommandSender& courier);
  bool send_removes(CommandSender& courier);
  bool send_moves(CommandSender& courier);
  bool send_envelopes(CommandSender& courier);
  bool send_rest(CommandSender& courier);

  Entries entries_;
  std::vector<Entry*> listed_, batch_;  ///< that wait; that go into one message
  Stamp clear_, hands_, quiet_, stamp_;
  wire::Hands hands_message_;
  wire::Quiet quiet_message_;
  wire::Move move_message_;
};

}  // namespace pacinian::client
