#pragma once

// Stubs of the player's mouse. The test sets what Unreal reads from the system.

#include "world.h"

struct FKey {};

struct EKeys {
  inline static const FKey LeftMouseButton;
};

class APlayerController : public AActor {
  STUB_BODY(APlayerController, AActor)
  /// Unreal knows no position while the cursor is hidden.
  bool GetMousePosition(float& X, float& Y) const {
    X = float(MouseX), Y = float(MouseY);
    return bShowMouseCursor;
  }
  void GetViewportSize(int32& X, int32& Y) const { X = 1920, Y = 1080; }
  bool IsInputKeyDown(const FKey&) const { return bMouseDown; }

  bool bShowMouseCursor = false, bMouseDown = false;
  double MouseX = 0.0, MouseY = 0.0;
};
