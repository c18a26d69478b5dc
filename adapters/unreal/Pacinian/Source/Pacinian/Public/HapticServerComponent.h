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
class UHapticScene;
struct FHapticLink;

/** The connection to `pacinian serve`, which makes the level's haptic components felt. If a level has several, the
 * first is used. The others wait and say so; one takes over when the first is gone.
 *
 * Each frame renews a lease at the server. A game that hangs, crashes or is paused in a debugger therefore falls
 * silent. The component never blocks the game's thread, except for up to half a second at the end of a connection. */
UCLASS(ClassGroup = (Haptics), meta = (BlueprintSpawnableComponent, DisplayName = "Haptic Server"))
class PACINIAN_API UHapticServerComponent : public UActorComponent {
  GENERATED_BODY()

 public:
  UHapticServerComponent();

  /** The path of the server's connection file, or its content (which begins with {), as on a headset. Empty: the
   * path in PACINIAN_CONNECTION, or the place where `pacinian serve` writes the file. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString ConnectionFile;

  /** Name of this client, shown to people. Empty: the project's name. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString ClientName;

  /** Clients with the same name share a scene, for example a game and a hand tracker. Empty: a scene of its own. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  FString SceneName;

  /** Time from the game's last frame to silence [s]. 0: the longest that the server allows, 0.25 s by default. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection", meta = (ClampMin = "0", ClampMax = "10", Units = "s"))
  float Lease = 0.0f;

  /** Starts a server when play begins, unless one runs: the standalone one in the plugin's folder (Server/pacinian),
   * or the one in Project Settings, Plugins, Pacinian. It ends with the game. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bStartServer = false;

  /** Connects when play begins. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bConnectOnPlay = true;

  /** Arms the output with the first connection, so that the scene is felt. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bArmOnConnect = true;

  /** Arms again after the connection was lost. After a standstill of the game the scene is felt again in any case. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bArmAgainAfterLoss = false;

  /** Arming takes the output from another client that has it, if the server allows this. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Haptics|Connection")
  bool bTakeOver = false;

  /** Factor on all radiation pressures, 0 to 1. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (ClampMin = "0", ClampMax = "1"))
  float Intensity = 1.0f;

  /** The solver. Empty: the server's. The list is that of the last server that this editor connected to. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (GetOptions = "GetSolvers"))
  FString Solver;

  /** The array: simulated, or a device. Empty: the server's. The list is that of the last server that this editor connected to. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = "Haptics", meta = (GetOptions = "GetBackends"))
  FString Backend;

  /** A session has started. Components put their objects by themselves. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticConnected OnConnected;

  /** The session has ended, and with it the sound. The component reconnects by itself. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticLost OnLost;

  /** The sound ended unasked. Code: "owner" (another client took over), "stopped" or "fault". */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticEnded OnEnded;

  /** The server refused a command. Code: see docs/wire.md; Advice: what to do. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticRefused OnRefused;

  /** The server has published a new state; at most once per frame. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticStateChanged OnStateChanged;

  /** A hand begins to feel an effect. Each effect has this event, too. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchBegan;

  /** A hand still feels an effect: its position and strength, 60 times a second. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchMoved;

  /** A hand no longer feels an effect. The argument is the last report of the touch. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticTouched OnTouchEnded;

  /** The game continues after a standstill of more than its lease [s]. It sounds again, unless something else ended
   * the sound. Whole: the whole program stood still, as at a breakpoint; otherwise a frame was long, or the editor
   * was paused. */
  UPROPERTY(BlueprintAssignable, Category = "Haptics")
  FHapticStoodStill OnStoodStill;

  /** Starts a server like bStartServer does. Returns false and the problem on failure. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool StartServer(FString& Problem) const;

  /** Stops the server that this program has started, if any, and with it the sound. May take five seconds. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  static void StopServer();

  /** Starts to connect, with the present properties. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Connect();

  /** Ends the session and the sound. May take half a second. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Disconnect();

  /** Replaces the session by a new one. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Reconnect();

  /** Arms the output, so that the scene is felt; see bTakeOver. Returns false without a session. */
  UFUNCTION(BlueprintCallable, Category = "Haptics")
  bool Arm();

  /** Disarms: the sound fades, and the output is released. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void Disarm();

  /** Silences the array at once, whoever owns the output, until Reset Output. Works even without a session,
   * and in the editor. If the server does not confirm it, the output log says so, and during play Get Problem. */
  UFUNCTION(BlueprintCallable, CallInEditor, Category = "Haptics")
  void EmergencyStop();

  /** Allows arming again after an emergency stop or a fault. */
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

  /** Returns whether this game has armed the output. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  bool IsArmed() const;

  UFUNCTION(BlueprintPure, Category = "Haptics")
  EHapticStatus GetStatus() const;

  /** Returns why there is no session and what to do, or the server's last refusal; empty if there is no problem. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetProblem() const;

  /** Returns why nothing can be felt, and what to do (for example, the nearest object and its distance); empty if something can. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetSilence() const;

  /** Returns the cause of silence for programs, one of docs/wire-messages.md, "not connected" or "not the owner";
   * empty if it sounds. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  FString GetSilenceCause() const;

  /** Returns the median round trip to the server [s]; 0 before the first. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetLatency() const;

  /** Returns the time from the game's last frame to silence, as granted by the server [s]; 0 without a session. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  float GetGrantedLease() const;

  UFUNCTION(BlueprintPure, Category = "Haptics")
  EHapticOutput GetOutput() const;

  /** Returns the server's solvers, after the empty choice. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  TArray<FString> GetSolvers() const;

  /** Returns the server's backends, after the empty choice. */
  UFUNCTION(BlueprintPure, Category = "Haptics")
  TArray<FString> GetBackends() const;

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void BeginDestroy() override;
  virtual void TickComponent(float DeltaTime, ELevelTick TickType, FActorComponentTickFunction* Tick) override;
#if WITH_EDITOR
  virtual void PostEditChangeProperty(FPropertyChangedEvent& Event) override;
#endif

  /** For C++: returns the engine-independent client, for what this component does not offer; null while not connected. */
  pacinian::Client* GetClient() const;

  /** For the other components: returns the connection, or null. */
  const TSharedPtr<FHapticLink>& GetLink() const { return Link; }

 private:
  void Start();
  FString GetWaiting() const;
  void Begun();
  void Refused(const pacinian::Refusal& Told);
  void ForgetRefusal(const UHapticScene& Scene);
  void Ended(const FString& Code, const FString& Message);
  void Report() const;
  void Choose(bool bIntensity, bool bSolver, bool bBackend);
  void Touched(const FHapticTouch& Touch, bool bBegins);

  TSharedPtr<FHapticLink> Link;
  FDelegateHandle Exit;
  FString Complaint;     ///< the server's last refusal in this session
  FString Unstopped;     ///< why an emergency stop was not confirmed
  bool bRefusedEffect = false;  ///< that refusal was of an effect
  bool bFirstSession = false;  ///< no session since Connect
  bool bInReserve = false;     ///< until the component in use is gone
  bool bWantsSound = false;    ///< armed, and not disarmed since
};
