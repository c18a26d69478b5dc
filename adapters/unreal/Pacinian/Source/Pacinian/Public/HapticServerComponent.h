#pragma once

#include "Components/ActorComponent.h"
#include "CoreMinimal.h"
#include "HapticTouch.h"
#include "HapticTypes.h"

#include "HapticServerComponent.generated.h"

DECLARE_DYNAMIC_MULTICAST_DELEGATE(FHapticConnected);
DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(FHapticLost, const FString&, Why);
DECLARE_DYNAMIC_MULTICAST_DELEGATE_TwoParams(FHapticEnded, const FString&, Code, const FString&, Message);
DECLARE_DYNAMIC_MULTICAST_DELEGATE_ThreeParams(FHapticRefused, const FString&, Code, const FString&, Message,
                                               const FString&, Advice);
DECLARE_DYNAMIC_MULTICAST_DELEGATE(FHapticStateChanged);
DECLARE_DYNAMIC_MULTICAST_DELEGATE_TwoParams(FHapticStoodStill, float, Seconds, bool, bWhole);

namespace pacinian {
class Client;
struct Refusal;
}
struct FHapticLink;

/**
 * The connection to `pacinian serve`, which lets the level's haptic components be felt. Of several in a level the first is used;
 * the others wait, say so, and one takes over when it goes.
 *
 * It tells the server in each frame that the game is alive: a game that hangs, crashes or is paused in a debugger falls
 * silent. The game's thread never waits for the server; only the end of a connection may take up to half a second.
 */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Server"))
class PACINIAN_API UHapticServerComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UHapticServerComponent();

  /** The server's connection file, or its content, which begins with {, as on a headset. Empty: that of PACINIAN_CONNECTION, or
   * where `pacinian serve` writes it. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString ConnectionFile;

  /** Who this is, for people who look at the server. Empty: the project's name. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString ClientName;

  /** Programs that give the same name share a scene, as a game and a hand tracker. Empty: a scene of its own. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString SceneName;

  /** From the game's last frame to silence [s]. 0: as long as the server allows, 0.25 s unless it is configured. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection", meta = (ClampMin = "0", ClampMax = "10", Units = "s"))
  float Lease = 0.0f;

  /** When play begins, starts the server unless one runs: the standalone one in the plugin's folder (Server/pacinian), or
   * the one that Project Settings, Plugins, Pacinian names. It ends with the game. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bStartServer = false;

  /** Connects when play begins. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bConnectOnPlay = true;

  /** Lets the scene be felt as soon as it is connected. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bArmOnConnect = true;

  /** Lets it be felt again by itself after the connection was lost. After the game stood still it is, in any case. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bArmAgainAfterLoss = false;

  /** Arming takes the output from another program that has it, if the server allows that. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bTakeOver = false;

  /** A factor on everything that is felt, 0 to 1. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1"))
  float Intensity = 1.0f;

  /** What computes the array's output. Empty: the server's. The list is that of the last server seen by this editor. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (GetOptions = "GetSolvers"))
  FString Solver;

  /** The array: simulated, or a device. Empty: the server's. The list is that of the last server seen by this editor. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (GetOptions = "GetBackends"))
  FString Backend;

  /** A session has begun, the first or a new one. Components put their objects by themselves. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticConnected OnConnected;

  /** The session is over: silence. It is tried to connect again. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticLost OnLost;

  /** Sound ended unasked. Code: "owner" (another program took over), "stopped" or "fault". */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticEnded OnEnded;

  /** The server would not do something. Code as in docs/wire.md; Advice: what to do. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticRefused OnRefused;

  /** The server has said what it emits, up to once in a frame. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticStateChanged OnStateChanged;

  /** A hand begins to feel an effect. Effects have this event, too. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchBegan;

  /** A hand feels an effect still, where and as strongly as told, 60 times a second. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchMoved;

  /** A hand feels an effect no more, as it was told last. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchEnded;

  /** The game stood still for longer than its lease [s], and sounds again if nothing else ended the sound. Whole: the whole
   * program did, as at a breakpoint; otherwise a frame was long, or the editor paused. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticStoodStill OnStoodStill;

  /** Starts the server, as bStartServer does. False, with the problem. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool StartServer(FString& Problem) const;

  /** Ends the server that this program has started, if it has: silence. May take five seconds. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  static void StopServer();

  /** Begins to connect, with the properties as they are now. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Connect();

  /** Ends the session: silence. May take up to half a second. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Disconnect();

  /** A new session in place of the one there is. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Reconnect();

  /** Lets the scene be felt, as bTakeOver says. False: not connected. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool Arm();

  /** Silence, softly; another program may have the output. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Disarm();

  /** Silence at once, whoever has the output, until Reset Output; also without a session. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void EmergencyStop();

  /** After an emergency stop or a fault: the output may be armed again. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void ResetOutput();

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetIntensity(float NewIntensity);

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetSolver(const FString& NewSolver);

  UFUNCTION(BlueprintCallable, Category = "Haptics")
  void SetBackend(const FString& NewBackend);

  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsConnected() const;

  /** Whether this game's scene may be felt now. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsArmed() const;

  UFUNCTION(BlueprintPure, Category = "Haptics")
  EHapticStatus GetStatus() const;

  /** Why it is not connected and what to do, or what the server last refused. Empty while all is well. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetProblem() const;

  /** Why nothing can be felt, and what to do, as the nearest object and its distance. Empty while something can. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetSilence() const;

  /** The same for programs: a cause of docs/wire-messages.md, "not connected" or "not the owner". Empty if it sounds. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetSilenceCause() const;

  /** Median round trip to the server [s]; 0 before the first. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetLatency() const;

  /** From the game's last frame to silence, as agreed with the server [s]; 0 without a session. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetGrantedLease() const;

  UFUNCTION(BlueprintPure, Category = "Haptics")
  EHapticOutput GetOutput() const;

  /** Solvers that the server has, after the empty choice. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  TArray<FString> GetSolvers() const;

  /** Backends that the server has, after the empty choice. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  TArray<FString> GetBackends() const;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void BeginDestroy() override;
  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;
#if WITH_EDITOR
  virtual void PostEditChangeProperty(FPropertyChangedEvent& Event) override;
#endif

  /** For C++: the engine-free client, for what is not here; null while it is not connected. */
  pacinian::Client* GetClient() const;

  /** For the other components: the connection, or null. */
  const TSharedPtr<FHapticLink>& GetLink() const { return Link; }

 private:
  void Start();
  FString GetWaiting() const;
  void Begun();
  void Refused(const pacinian::Refusal& Told);
  void Ended(const FString& Code, const FString& Message);
  void Choose(bool bIntensity, bool bSolver, bool bBackend);
  void Leave();
  void Touched(const FHapticTouch& Touch, bool bBegins);

  TSharedPtr<FHapticLink> Link;
  FDelegateHandle Exit;
  FString Complaint;     ///< what the server last refused in this session
  bool bFirst = false;   ///< no session since Connect
  bool bWaits = false;   ///< until the one that is used is gone
  bool bWanted = false;  ///< armed, and not disarmed since
};
