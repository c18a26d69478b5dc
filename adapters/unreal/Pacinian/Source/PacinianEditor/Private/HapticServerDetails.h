#pragma once

#include "CoreMinimal.h"
#include "IDetailCustomization.h"

class UHapticServerComponent;

/** Shows the state of a haptic server component above its properties. */
class FHapticServerDetails : public IDetailCustomization {
 public:
  static TSharedRef<IDetailCustomization> Make() { return MakeShared<FHapticServerDetails>(); }

  virtual void CustomizeDetails(IDetailLayoutBuilder& Layout) override;

 private:
  FText Status() const;
  FText Output() const;
  FText Silence() const;
  FText Latency() const;
  FText Problem() const;

  TWeakObjectPtr<UHapticServerComponent> Server;
};
