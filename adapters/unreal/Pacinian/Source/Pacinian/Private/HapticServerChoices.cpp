#include "HapticServerComponent.h"
#include "Link.h"

namespace wire = pacinian::wire;

void UHapticServerComponent::SetIntensity(float NewIntensity) {
  Intensity = FMath::Clamp(NewIntensity, 0.0f, 1.0f);
  Choose(true, false, false);
}

void UHapticServerComponent::SetSolver(const FString& NewSolver) {
  Solver = NewSolver;
  Choose(false, true, false);
}

void UHapticServerComponent::SetBackend(const FString& NewBackend) {
  Backend = NewBackend;
  Choose(false, false, true);
}

void UHapticServerComponent::Choose(bool bIntensity, bool bSolver, bool bBackend) {
  if (!IsConnected()) return;
  wire::Select Choice;
  if (bIntensity) Choice.intensity = FMath::Clamp(Intensity, 0.0f, 1.0f);
  if (bSolver && !Solver.IsEmpty()) Choice.solver = wire::Choice{Haptic::Text(Solver), {}};
  if (bBackend && !Backend.IsEmpty()) Choice.backend = wire::Choice{Haptic::Text(Backend), {}};
  if (Choice.intensity || Choice.solver || Choice.backend) Link->Client.select(MoveTemp(Choice));
}

#if WITH_EDITOR
void UHapticServerComponent::PostEditChangeProperty(FPropertyChangedEvent& Event) {
  Super::PostEditChangeProperty(Event);
  const FName Changed = Event.GetPropertyName();
  Choose(Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Intensity),
         Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Solver),
         Changed == GET_MEMBER_NAME_CHECKED(UHapticServerComponent, Backend));
}
#endif
