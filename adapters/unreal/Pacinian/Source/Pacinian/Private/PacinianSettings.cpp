#include "PacinianSettings.h"

UPacinianSettings::UPacinianSettings() {
  Solvers = {TEXT(""), TEXT("auto"), TEXT("lagrange"), TEXT("pseudo-inverse"), TEXT("gs-pat")};
  Backends = {TEXT(""), TEXT("simulated")};
}

FName UPacinianSettings::GetCategoryName() const { return FName(TEXT("Plugins")); }
