#pragma once

#include "CoreMinimal.h"
#include "GameFramework/Actor.h"

#include "HapticArray.generated.h"

class UArrayOriginComponent;
class UEmissionViewComponent;
class UHapticServerComponent;

/** An array to drag into a level: its pose, the connection to the server, and a view of what it emits. */
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
