#pragma once

// Stubs of meshes, colliders, hand tracking, saved games, drawing and settings.

#include <filesystem>

#include "world.h"

class UDataAsset : public UObject {
  STUB_BODY(UDataAsset, UObject)
};
/// Linear between keys.
class UCurveFloat : public UObject {
  STUB_BODY(UCurveFloat, UObject)
  float GetFloatValue(float Time) const {
    const auto Next = Keys.upper_bound(Time);
    if (Next == Keys.begin() || Next == Keys.end()) return Next == Keys.begin() ? Next->second : Keys.rbegin()->second;
    const auto Before = std::prev(Next);
    const float Share = (Time - Before->first) / (Next->first - Before->first);
    return Before->second + Share * (Next->second - Before->second);
  }
  void GetTimeRange(float& First, float& Last) const {
    First = Keys.empty() ? 0.0F : Keys.begin()->first;
    Last = Keys.empty() ? 0.0F : Keys.rbegin()->first;
  }
  std::map<float, float> Keys;
};
class UDeveloperSettings : public UObject {
  STUB_BODY(UDeveloperSettings, UObject)
  virtual FName GetCategoryName() const { return {}; }
};

struct FPositionVertexBuffer {
  uint32 GetNumVertices() const { return static_cast<uint32>(Positions.size()); }
  const FVector3f& VertexPosition(uint32 i) const { return Positions.at(i); }
  std::vector<FVector3f> Positions;
};
struct FIndexArrayView {
  int32 Num() const { return static_cast<int32>(Indices->size()); }
  uint32 operator[](int32 i) const { return Indices->at(i); }
  const std::vector<uint32>* Indices;
};
struct FRawStaticIndexBuffer {
  FIndexArrayView GetArrayView() const { return {&Indices}; }
  std::vector<uint32> Indices;
};
struct FStaticMeshVertexBuffers {
  FPositionVertexBuffer PositionVertexBuffer;
};
struct FStaticMeshLODResources {
  FStaticMeshVertexBuffers VertexBuffers;
  FRawStaticIndexBuffer IndexBuffer;
};
struct FStaticMeshRenderData {
  TArray<FStaticMeshLODResources> LODResources;
};
class UStaticMesh : public UObject {
  STUB_BODY(UStaticMesh, UObject)
  const FStaticMeshRenderData* GetRenderData() const { return &Data; }
  FStaticMeshRenderData Data;
  bool bAllowCPUAccess = false;
};
struct FPlatformProperties {
  static bool RequiresCookedData() { return false; }
};

struct FKSphereElem {
  FVector Center;
  float Radius = 1.0F;
  FKSphereElem GetFinalScaled(const FVector& Scale, const FTransform&) const {
    const double Least = std::min({std::abs(Scale.X), std::abs(Scale.Y), std::abs(Scale.Z)});
    return {Center * Scale, float(Radius * Least)};
  }
};
struct FKBoxElem {
  FVector Center;
  FRotator Rotation;
  float X = 1.0F, Y = 1.0F, Z = 1.0F;
  FKBoxElem GetFinalScaled(const FVector& Scale, const FTransform&) const {
    return {Center * Scale, Rotation, float(X * Scale.X), float(Y * Scale.Y), float(Z * Scale.Z)};
  }
};
struct FKSphylElem {
  FVector Center;
  FRotator Rotation;
  float Radius = 1.0F, Length = 1.0F;
  FKSphylElem GetFinalScaled(const FVector& Scale, const FTransform&) const {
    return {Center * Scale, Rotation, float(Radius * std::max(Scale.X, Scale.Y)), float(Length * Scale.Z)};
  }
};
struct FKAggregateGeom {
  TArray<FKSphereElem> SphereElems;
  TArray<FKBoxElem> BoxElems;
  TArray<FKSphylElem> SphylElems;
};
class UBodySetup : public UObject {
  STUB_BODY(UBodySetup, UObject)
  FKAggregateGeom AggGeom;
};
class UPrimitiveComponent : public USceneComponent {
  STUB_BODY(UPrimitiveComponent, USceneComponent)
  virtual UBodySetup* GetBodySetup() { return &Body; }
  UBodySetup Body;
};
class UStaticMeshComponent : public UPrimitiveComponent {
  STUB_BODY(UStaticMeshComponent, UPrimitiveComponent)
  UStaticMesh* GetStaticMesh() const { return Mesh; }
  UStaticMesh* Mesh = nullptr;
};

enum class EControllerHand : uint8 { Left, Right };
enum class EXRSpaceType : uint8 { UnrealWorldSpace, XRTrackingSpace };
enum class ETrackingStatus : uint8 { NotTracked, InertialOnly, Tracked };
struct FXRHandTrackingState {
  bool bValid = false;
  ETrackingStatus TrackingStatus = ETrackingStatus::NotTracked;
  TArray<FVector> HandKeyLocations;
  TArray<float> HandKeyRadii;
};
class IXRTrackingSystem {
 public:
  virtual ~IXRTrackingSystem() = default;
  virtual void GetHandTrackingState(UObject*, const EXRSpaceType, const EControllerHand, FXRHandTrackingState&) = 0;
};
class UEngine : public UObject {
  STUB_BODY(UEngine, UObject)
  void AddOnScreenDebugMessage(uint64, float, const FColor&, const FString& Message) { StubScreen = Message; }
  TSharedPtr<IXRTrackingSystem> XRSystem;
  FString StubScreen;
};
extern UEngine* GEngine;

struct FApp {
  static const TCHAR* GetProjectName() { return TEXT("StubGame"); }
};

class USaveGame : public UObject {
  STUB_BODY(USaveGame, UObject)
};
/// Keeps the objects themselves instead of copies.
struct UGameplayStatics {
  static std::map<FString, USaveGame*>& Slots() {
    static std::map<FString, USaveGame*> Made;
    return Made;
  }
  static bool SaveGameToSlot(USaveGame* Given, const FString& Slot, int32) { return (Slots()[Slot] = Given) != nullptr; }
  static bool DoesSaveGameExist(const FString& Slot, int32) { return Slots().count(Slot) > 0; }
  static USaveGame* LoadGameFromSlot(const FString& Slot, int32) { return Slots()[Slot]; }
  static bool DeleteGameInSlot(const FString& Slot, int32) { return Slots().erase(Slot) > 0; }
};

/// Counts drawing calls.
extern int StubDrawn;
inline void DrawDebugLine(const UWorld*, const FVector&, const FVector&, const FColor&) { ++StubDrawn; }
inline void DrawDebugPoint(const UWorld*, const FVector&, float, const FColor&) { ++StubDrawn; }
inline void DrawDebugCoordinateSystem(const UWorld*, const FVector&, const FRotator&, float) { ++StubDrawn; }

/// Files and plug-ins: no plug-in has a file.
struct FPaths {
  static FString Combine(const FString& Folder, const FString& Name) { return Folder + TEXT("/") + Name; }
  static FString ConvertRelativePathToFull(const FString& Path) { return Path; }
  static FString ProjectLogDir() { return StubLogs; }
  static bool FileExists(const FString&) { return false; }
  static inline FString StubLogs;
};
struct IFileManager {
  static IFileManager& Get() {
    static IFileManager Made;
    return Made;
  }
  bool MakeDirectory(const TCHAR* Path, bool) {
    std::error_code Error;
    std::filesystem::create_directories(stub::utf8(Path), Error);
    return std::filesystem::is_directory(stub::utf8(Path), Error);
  }
};
template <class T>
struct TAutoConsoleVariable {
  TAutoConsoleVariable(const TCHAR*, T Given, const TCHAR*) : Value(Given) {}
  T GetValueOnGameThread() const { return Value; }
  T Value;
};
struct IPlugin {
  FString GetBaseDir() const { return FString(); }
};
struct IPluginManager {
  static IPluginManager& Get() {
    static IPluginManager Made;
    return Made;
  }
  TSharedPtr<IPlugin> FindPlugin(const FString&) { return nullptr; }
};
