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

/// The waiting commands about one object: put or remove, then move, then envelope.
struct Waiting {
  Stamp put, removed, moved, enveloped;
  bool listed = false;
  wire::Object object;
  Place place{};
  Speed speed{};
  bool moves = false;
  wire::Envelope envelope;
};

/// The commands that wait to be sent. A newer command drops waiting ones that it replaces: of each kind for one object
/// only the newest waits, and `put` and `remove` replace all kinds. A command is also dropped when its time to live is
/// over. Does not read a clock: times are arguments.
///
/// Keeps the memory of names, so that moving an existing object allocates nothing.
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
  /// Drops all commands.
  void forget();
  /// Moves the newer commands of another outbox into this one.
  void take(Outbox& newer);
  /// Sends the commands whose time to live is not over, until there is no room. Returns whether none is left.
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
  std::vector<Entry*> listed_, batch_;  ///< waiting; for one message
  Stamp clear_, hands_, quiet_, stamp_;
  wire::Hands hands_message_;
  wire::Quiet quiet_message_;
  wire::Move move_message_;
};

}  // namespace pacinian::client
