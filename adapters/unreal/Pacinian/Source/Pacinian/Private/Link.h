#pragma once

#include "Space.h"

/** A connection, and what is used anew in each frame. */
struct FHapticLink {
  explicit FHapticLink(pacinian::Options Options) : Client(MoveTemp(Options)) {}

  pacinian::Client Client;
  uint32 Session = 0;  ///< counts them; 0 before the first
  FHapticSpace Space;

  std::vector<pacinian::wire::HandFrame> Hands;
  std::vector<pacinian::wire::Zone> Zones, SentZones;
  uint32 HandsSession = 0, ZonesSession = 0, ListedSession = 0;  ///< in which they were told
};

/** A hand to be filled. */
struct FHapticHand {
  pacinian::wire::HandFrame& Frame;
};

/** What an effect needs to tell the server of itself. */
struct FHapticFrame {
  pacinian::Client& Client;
  const FHapticSpace& Space;
  uint32 Session;
  double Elapsed;  ///< since the last frame [s]
};

/** An effect as it was sent. */
struct FHapticBody {
  std::string Name;
  pacinian::wire::Object Object;
  pacinian::Rigid Pose;
  FVector Scale = FVector::OneVector;
  uint64 Fingerprint = 0;  ///< of its shape
};
