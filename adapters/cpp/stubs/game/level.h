#pragma once

#include <istream>
#include <memory>
#include <string>

#include "Components/PrimitiveComponent.h"
#include "EmissionViewComponent.h"
#include "GameFramework/PlayerController.h"
#include "HapticArray.h"
#include "HapticHandComponent.h"
#include "HapticPointComponent.h"
#include "HapticServerComponent.h"
#include "HapticSurfaceComponent.h"
#include "HapticVolumeComponent.h"
#include "QuietZoneComponent.h"

/// A level with an array, a ball, a point and a hand, controlled by commands.
class Level {
 public:
  /// more: `unarmed` and `again` are settings of the server component; `handless` leaves out the hand;
  /// `dedicated` plays on a dedicated server;
  /// `shared` shares the scene `hall`.
  Level(const std::string& connection, const std::string& more);
  ~Level() { world->end(EEndPlayReason::LevelTransition); }

  void tick(float seconds);
  /// Executes a command with its arguments.
  void act(const std::string& word, std::istream& rest);
  void end(EEndPlayReason::Type reason) { world->end(reason); }

 private:
  void serve(std::istream& rest);
  void place(std::istream& rest);
  void joints(std::istream& rest);
  void open(std::istream& rest);
  void mouse(std::istream& rest);
  void zone(std::istream& rest);
  void effect(const std::string& word, std::istream& rest);
  void surface(std::istream& rest);
  void align(std::istream& rest);
  void shelf(std::istream& rest);
  void second();
  void pair();
  void outline(std::istream& rest);
  void status();

  UHapticEffectComponent* named(const std::string& name);

  std::unique_ptr<UWorld> world = std::make_unique<UWorld>();
  AHapticArray* array = nullptr;
  AActor* things = nullptr;
  AActor* player = nullptr;
  APlayerController* controller = nullptr;
  UHapticServerComponent* server = nullptr;
  UHapticServerComponent* rival = nullptr;
  UPrimitiveComponent* ball = nullptr;
  UPrimitiveComponent* box = nullptr;
  UHapticVolumeComponent* volume = nullptr;
  UHapticPointComponent* point = nullptr;
  UHapticSurfaceComponent* plate = nullptr;
  UHapticHandComponent* hand = nullptr;
  UQuietZoneComponent* quiet = nullptr;
  FHapticTouch felt;    ///< the last report
  TArray<FVector> rest;  ///< the hand's joints [cm]
  double sway = 0.0;     ///< of the hand along x [cm]
  double time = 0.0;     ///< [s]
};
