#include "HapticArray.h"

#include "ArrayOriginComponent.h"
#include "EmissionViewComponent.h"
#include "HapticServerComponent.h"

AHapticArray::AHapticArray() {
  Origin = CreateDefaultSubobject<UArrayOriginComponent>(TEXT("Origin"));
  Server = CreateDefaultSubobject<UHapticServerComponent>(TEXT("Server"));
  View = CreateDefaultSubobject<UEmissionViewComponent>(TEXT("View"));
  SetRootComponent(Origin);
}
