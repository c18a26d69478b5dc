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

  /** The program that is the server, for Tools, Start Haptic Server: its path, or its name if the system finds it. */
  UPROPERTY(Config, EditAnywhere, Category = "Server")
  FString ServerCommand = TEXT("pacinian");

  /** What it is told, as `serve --backend simulated`. */
  UPROPERTY(Config, EditAnywhere, Category = "Server")
  FString ServerArguments = TEXT("serve");

  /** Solvers to choose from; those of the last server that was connected. */
  UPROPERTY(Transient)
  TArray<FString> Solvers;

  /** Backends to choose from; those of the last server that was connected. */
  UPROPERTY(Transient)
  TArray<FString> Backends;

  virtual FName GetCategoryName() const override;
};
