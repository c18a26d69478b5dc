#include "outbox.h"

#include <utility>

namespace pacinian::client {

Outbox::Entry& Outbox::at(std::string_view name) {
  auto found = entries_.find(name);
  if (found == entries_.end()) found = entries_.try_emplace(std::string(name)).first;
  if (!found->second.listed) listed_.push_back(&*found);
  found->second.listed = true;
  return *found;
}

void Outbox::put(std::string_view name, wire::Object object, Stamp stamp) {
  Waiting& waiting = at(name).second;
  waiting.removed.waits = waiting.moved.waits = waiting.enveloped.waits = false;
  waiting.put = stamp;
  waiting.object = std::move(object);
}

void Outbox::remove(std::string_view name, Stamp stamp) {
  Waiting& waiting = at(name).second;
  waiting.put.waits = waiting.moved.waits = waiting.enveloped.waits = false;
  waiting.removed = stamp;
}

void Outbox::move(std::string_view name, const Place& place, const Speed* speed, Stamp stamp) {
  Waiting& waiting = at(name).second;
  waiting.moved = stamp;
  waiting.place = place;
  waiting.moves = speed != nullptr;
  if (speed) waiting.speed = *speed;
}

void Outbox::envelope(std::string_view name, const wire::Envelope& envelope, Stamp stamp) {
  Waiting& waiting = at(name).second;
  waiting.enveloped = stamp;
  waiting.envelope = envelope;
}

void Outbox::hands(const std::vector<wire::HandFrame>& hands, Stamp stamp) {
  hands_ = stamp;
  hands_message_.hands = hands;
}

void Outbox::quiet(const std::vector<wire::Zone>& zones, Stamp stamp) {
  quiet_ = stamp;
  quiet_message_.zones = zones;
}

void Outbox::clear(Stamp stamp) {
  forget();
  clear_ = stamp;
}

bool Outbox::empty() const {
  return listed_.empty() && !clear_.waits && !hands_.waits && !quiet_.waits;
}

void Outbox::forget() {
  for (Entry* entry : listed_) {
    Waiting& waiting = entry->second;
    waiting.put.waits = waiting.removed.waits = waiting.moved.waits = false;
    waiting.enveloped.waits = waiting.listed = false;
  }
  listed_.clear();
  clear_.waits = hands_.waits = quiet_.waits = false;
}

void Outbox::take(Outbox& newer) {
  if (newer.clear_.waits) clear(newer.clear_);
  for (Entry* entry : newer.listed_) {
    Waiting& waiting = entry->second;
    if (waiting.removed.waits) remove(entry->first, waiting.removed);
    if (waiting.put.waits) put(entry->first, std::move(waiting.object), waiting.put);
    if (waiting.moved.waits)
      move(entry->first, waiting.place, waiting.moves ? &waiting.speed : nullptr, waiting.moved);
    if (waiting.enveloped.waits) envelope(entry->first, waiting.envelope, waiting.enveloped);
  }
  if (newer.hands_.waits) hands(newer.hands_message_.hands, newer.hands_);
  if (newer.quiet_.waits) quiet(newer.quiet_message_.zones, newer.quiet_);
  newer.forget();
}

}  // namespace pacinian::client
