#include "outbox.h"
#include "pacinian/wire/bulk.h"
#include "pacinian/wire/protocol.h"
#include "pacinian/wire/writer.h"

namespace pacinian::client {

namespace {

constexpr std::size_t most = wire::MAX_OBJECTS;  // in one message
constexpr std::size_t full = 900'000;     // [bytes] of objects in one message
constexpr std::size_t kept = 1024;        // names kept in memory: more than a server accepts
constexpr double moment = 0.01;           // [s] commands written within it are sent together, with one time

std::size_t measure(const wire::Object& object) {
  wire::Writer writer;
  writer.put(object);
  return writer.size();
}

}  // namespace

/// Fills `batch_` with commands that were written at about one time, the oldest first. Returns false if there are none.
bool Outbox::gather(Stamp Waiting::*kind) {
  const Stamp* oldest = nullptr;
  for (const Entry* entry : listed_) {
    const Stamp& stamp = entry->second.*kind;
    if (stamp.waits && (!oldest || stamp.time < oldest->time)) oldest = &stamp;
  }
  batch_.clear();
  if (!oldest) return false;
  stamp_ = *oldest;
  for (Entry* entry : listed_) {
    const Stamp& stamp = entry->second.*kind;
    if (stamp.waits && stamp.ttl == stamp_.ttl && stamp.time - stamp_.time < moment &&
        batch_.size() < most)
      batch_.push_back(entry);
  }
  return true;
}

void Outbox::sent(Stamp Waiting::*kind) {
  for (Entry* entry : batch_) (entry->second.*kind).waits = false;
}

void Outbox::drop_overdue(double now) {
  const auto drop = [now](Stamp& stamp) {
    if (now - stamp.time > stamp.ttl) stamp.waits = false;
  };
  for (Entry* entry : listed_)
    for (Stamp Waiting::*kind :
         {&Waiting::put, &Waiting::removed, &Waiting::moved, &Waiting::enveloped})
      drop(entry->second.*kind);
  for (Stamp* stamp : {&clear_, &hands_, &quiet_}) drop(*stamp);
}

bool Outbox::send_removes(CommandSender& courier) {
  wire::Remove message;
  while (gather(&Waiting::removed)) {
    message.names.clear();
    for (const Entry* entry : batch_) message.names.push_back(entry->first);
    if (!courier.send(message, stamp_)) return false;
    sent(&Waiting::removed);
  }
  return true;
}

bool Outbox::send_puts(CommandSender& courier) {
  while (gather(&Waiting::put)) {
    wire::Put message;
    std::size_t filled = 0, count = 0;
    for (const Entry* entry : batch_) {
      const std::size_t size = measure(entry->second.object);
      if (count > 0 && filled + size > full) break;
      message.objects.emplace_back(entry->first, entry->second.object);
      filled += size;
      ++count;
    }
    batch_.resize(count);
    if (!courier.send(message, stamp_)) return false;
    sent(&Waiting::put);
  }
  return true;
}

bool Outbox::send_moves(CommandSender& courier) {
  while (gather(&Waiting::moved)) {
    move_message_.names.resize(batch_.size());
    move_message_.poses.clear();
    move_message_.velocities.clear();
    bool moves = false;
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const Waiting& waiting = batch_[i]->second;
      move_message_.names[i] = batch_[i]->first;
      for (const float value : waiting.place) wire::append(move_message_.poses, value);
      moves = moves || waiting.moves;
    }
    for (const Entry* entry : batch_) {
      const Speed speed = entry->second.moves ? entry->second.speed : Speed{};
      for (const float value : speed)
        if (moves) wire::append(move_message_.velocities, value);
    }
    if (!courier.send(move_message_, stamp_)) return false;
    sent(&Waiting::moved);
  }
  return true;
}

bool Outbox::send_envelopes(CommandSender& courier) {
  for (Entry* entry : listed_) {
    Waiting& waiting = entry->second;
    if (!waiting.enveloped.waits) continue;
    wire::Envelopes message;
    message.names = {entry->first};
    message.envelope = waiting.envelope;
    if (!courier.send(message, waiting.enveloped)) return false;
    waiting.enveloped.waits = false;
  }
  return true;
}

bool Outbox::send_rest(CommandSender& courier) {
  if (hands_.waits && !courier.send(hands_message_, hands_)) return false;
  hands_.waits = false;
  if (quiet_.waits && !courier.send(quiet_message_, quiet_)) return false;
  quiet_.waits = false;
  return true;
}

bool Outbox::flush(double now, CommandSender& courier) {
  if (empty()) return true;
  drop_overdue(now);
  if (clear_.waits) {
    wire::Clear message;
    if (!courier.send(message, clear_)) return false;
    clear_.waits = false;
  }
  if (!send_removes(courier) || !send_puts(courier) || !send_moves(courier) || !send_envelopes(courier) ||
      !send_rest(courier))
    return false;
  forget();
  if (entries_.size() > kept) entries_.clear();
  return true;
}

}  // namespace pacinian::client
