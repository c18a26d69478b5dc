#pragma once

#include "Space.h"

class UHapticServerComponent;

/** A connection, with buffers that each frame reuses. */
struct FHapticLink {
  explicit FHapticLink(pacinian::Options Options) : Client(MoveTemp(Options)) {}

  pacinian::Client Client;
  uint32 Session = 0;  ///< number of the session; 0 before the first
  FHapticSpace Space;

  static constexpr double Never = 1e300;

  std::vector<pacinian::wire::HandFrame> Hands;
  std::vector<pacinian::wire::Zone> Zones, SentZones;
  double ZonesDue = Never;  ///< by the client's clock [s]: when they are sent again
  double Ticked = 0.0;      ///< by the client's clock [s]: the last frame
  double Reported = Never;  ///< by the client's clock [s]: the last frame, with or without a session
  int32 LongFrames = 0;     ///< how many frames in a row took longer than the lease
  FString LoggedProblem;    ///< why there is no session, as last logged
  TArray<FVector> Corners;  ///< of the array, in its own frame [cm]
  uint32 HandsSession = 0, ZonesSession = 0, ListedSession = 0, CornersSession = 0;  ///< in which they were last set
};

/** A hand to be written. */
struct FHapticHand {
  pacinian::wire::HandFrame& Frame;
};

/** What an effect needs in order to send itself. */
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
  TArray<uint64> Values;  ///< on which its shape depends, except for its scale
};

namespace Haptic {

/** Returns the client's options from the component's properties. */
pacinian::Options MakeOptions(const UHapticServerComponent& Server);

/** Stores the server's plug-ins for the editor's lists. */
void ListPlugins(FHapticLink& Link);

}  // namespace Haptic
