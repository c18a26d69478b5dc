#pragma once

#include "CoreMinimal.h"

// The engine-independent core. Its headers include only the standard library.
THIRD_PARTY_INCLUDES_START
#include "pacinian/client.h"
#include "pacinian/space/calibration.h"
#include "pacinian/space/unreal.h"
#include "pacinian/wire/bulk.h"
THIRD_PARTY_INCLUDES_END

DECLARE_LOG_CATEGORY_EXTERN(LogPacinian, Log, All);

namespace Haptic {

inline FString Text(const std::string& Given) { return FString(UTF8_TO_TCHAR(Given.c_str())); }

inline std::string Text(const FString& Given) { return std::string(TCHAR_TO_UTF8(*Given)); }

inline pacinian::Vec3 Vec(const FVector& Given) { return {Given.X, Given.Y, Given.Z}; }

inline FVector Vec(const pacinian::Vec3& Given) { return FVector(Given.x, Given.y, Given.z); }

}  // namespace Haptic
