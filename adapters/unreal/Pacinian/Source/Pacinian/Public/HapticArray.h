#pragma once

#include "CoreMinimal.h"
#include "GameFramework/Actor.h"

#include "HapticArray.generated.h"

class UArrayOriginComponent;
class UEmissionViewComponent;
class UHapticServerComponent;

/** An array, ready to be dragged into a level: where it stands, the connection to its server, and what it emits. */
UCLASS(meta = (DisplayName = "Haptic Array"))
class PACINIAN_API AHapticArray : public AActor {
  GENERATED_BODY()

 public:
  AHapticArray();

  UPROPERTY(VisibleAnywhere, BlueprintReadOnly, Category = "Haptics")
  TObjectPtr<UArrayOriginComponent> Origin;

  UPROPERTY(VisibleAnywhere, BlueprintReadOnly, Category = "Haptics")
  TObjectPtr<UHapticServerComponent> Server;

  UPROPERTY(VisibleAnywhere, BlueprintReadOnly, Category = "Haptics")
  TObjectPtr<UEmissionViewComponent> View;
};
