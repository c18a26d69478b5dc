#pragma once

#include "CoreMinimal.h"
#include "Engine/DeveloperSettings.h"

#include "PacinianSettings.generated.h"

/** The page Project Settings, Plugins, Pacinian. */
UCLASS(Config = Game, DefaultConfig, meta = (DisplayName = "Pacinian"))
class PACINIAN_API UPacinianSettings : public UDeveloperSettings {
  GENERATED_BODY()

 public:
  UPacinianSettings();

  /** The server program: its path, or its name if the system finds it. Ignored if the plugin's folder contains a
   * standalone server, Server/pacinian. */
  UPROPERTY(Config, EditAnywhere, Category = "Server")
  FString ServerCommand = TEXT("pacinian");

  /** Arguments of `serve`, one word each, such as `--backend` and `simulated`, or the path of a configuration. */
  UPROPERTY(Config, EditAnywhere, Category = "Server")
  TArray<FString> ServerArguments;

  /** The radiation pressure of an effect whose relative strength is 1 [Pa]. */
  UPROPERTY(Config, EditAnywhere, Category = "Effects", meta = (ClampMin = "0.001"))
  float FullPressure = 20.0f;

  /** The solvers of the last connected server. */
  UPROPERTY(Transient)
  TArray<FString> Solvers;

  /** The backends of the last connected server. */
  UPROPERTY(Transient)
  TArray<FString> Backends;

  virtual FName GetCategoryName() const override;
};
