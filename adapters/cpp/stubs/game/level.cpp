#include "level.h"

#include <cmath>
#include <set>
#include <sstream>

#include "ArrayOriginComponent.h"
#include "Curves/CurveFloat.h"
#include "Engine/StaticMesh.h"
#include "HapticEnvelope.h"
#include "Misc/Paths.h"
#include "PacinianSettings.h"

namespace {

void tell(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

std::string quoted(const FString& given) {
  std::string made;
  for (const char c : stub::utf8(*given)) made += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return '"' + made + '"';
}

std::string numbers(const TArray<FVector>& given) {
  std::ostringstream made;
  made.precision(9);
  for (const FVector& each : given) made << (made.tellp() > 0 ? "," : "") << each.X << ',' << each.Y << ',' << each.Z;
  return '[' + made.str() + ']';
}

void tell(const FHapticTouch& touch, const char* event) {
  tell(std::string(R"({"event": ")") + event + R"(", "code": "", "effect": )" + quoted(touch.Effect) + R"(, "hand": )" +
       quoted(touch.Hand) + R"(, "strength": )" + std::to_string(touch.Strength) + R"(, "at": )" +
       numbers({touch.Position}) + "}");
}

FVector vector(std::istream& from) {
  FVector made;
  from >> made.X >> made.Y >> made.Z;
  return made;
}

FString word(std::istream& from) {
  std::string made;
  from >> made;
  return UTF8_TO_TCHAR(made.c_str());
}

}  // namespace

Level::Level(const std::string& connection, const std::string& more) {
  const auto has = [&](const char* what) { return more.find(what) != std::string::npos; };
  if (has("dedicated")) UActorComponent::StubNetMode = NM_DedicatedServer;
  FPaths::StubLogs = UTF8_TO_TCHAR(connection.substr(0, connection.rfind('/')).c_str()) + FString(TEXT("/Saved/Logs"));
  array = world->spawn<AHapticArray>(TEXT("Array"));
  server = array->Server;
  server->ConnectionFile = UTF8_TO_TCHAR(connection.c_str());
  server->bArmOnConnect = !has("unarmed");
  server->bArmAgainAfterLoss = has("again");
  if (has("shared")) server->SceneName = TEXT("hall");
  if (has("short")) server->Lease = 0.25F;
  server->OnConnected.Add([] { tell(R"({"event": "connected", "code": ""})"); });
  server->OnLost.Add([](const FString& why) { tell(R"({"event": "lost", "code": )" + quoted(why) + "}"); });
  server->OnEnded.Add([](const FString& code, const FString&) {
    tell(R"({"event": "ended", "code": )" + quoted(code) + "}");
  });
  server->OnRefused.Add([](const FString& code, const FString& message, const FString&) {
    tell(R"({"event": "refused", "code": )" + quoted(code) + R"(, "message": )" + quoted(message) + "}");
  });
  server->OnTouchMoved.Add([this](const FHapticTouch& touch) { felt = touch; });
  server->OnTouchEnded.Add([](const FHapticTouch& touch) { tell(touch, "left"); });
  server->OnStoodStill.Add([](float, bool whole) {
    tell(std::string(R"({"event": "stood still", "code": "", "whole": )") + (whole ? "true}" : "false}"));
  });
  things = world->spawn<AActor>(TEXT("Things"));
  ball = things->CreateDefaultSubobject<UPrimitiveComponent>(TEXT("Sphere"));
  ball->SetupAttachment(array->Origin);
  ball->Body.AggGeom.SphereElems.Add({FVector::ZeroVector, 3.0F});
  volume = things->CreateDefaultSubobject<UHapticVolumeComponent>(TEXT("Volume"));
  volume->SetupAttachment(ball);
  volume->EffectName = TEXT("ball");
  volume->OnTouchBegan.Add([](const FHapticTouch& touch) { tell(touch, "touch"); });
  volume->Envelope = NewObject<UHapticEnvelope>(things);
  point = things->CreateDefaultSubobject<UHapticPointComponent>(TEXT("Point"));
  point->SetupAttachment(array->Origin);
  point->bAutoActivate = false;
  plate = things->CreateDefaultSubobject<UHapticSurfaceComponent>(TEXT("Surface"));
  plate->SetupAttachment(array->Origin);
  plate->bAutoActivate = false;
  player = world->spawn<AActor>(TEXT("Player"));
  world->StubPlayer = controller = world->spawn<APlayerController>(TEXT("Controller"));
  if (!has("handless")) {
    hand = player->CreateDefaultSubobject<UHapticHandComponent>(TEXT("Hand"));
    hand->Source = EHapticHandSource::Game;
  }
  quiet = player->CreateDefaultSubobject<UQuietZoneComponent>(TEXT("Head"));
  quiet->SetRelativeTransform(FTransform(FQuat(), FVector(0.0, 0.0, 500.0)));
  // The server's component comes last, which may happen in a level.
  for (AActor* actor : {things, player, static_cast<AActor*>(array)}) world->begin(actor);
}

void Level::tick(float seconds) {
  time += seconds;
  if (rest.Num() > 0) {
    TArray<FVector> now;
    for (const FVector& joint : rest) now.Add(joint + FVector(sway * std::sin(6.28318530718 * time), 0.0, 0.0));
    hand->SetJoints(now);
  }
  world->tick(seconds);
}

void Level::act(const std::string& what, std::istream& from) {
  if (what == "place") return place(from);
  if (what == "joints") return joints(from);
  if (what == "status") return status();
  if (what == "quiet") return zone(from);
  if (what == "align") return align(from);
  if (what == "outline") return outline(from);
  if (what == "connect") server->Connect();
  if (what == "serve") serve(from);
  if (what == "unserve") UHapticServerComponent::StopServer();
  if (what == "disconnect") server->Disconnect();
  if (what == "reconnect") server->Reconnect();
  if (what == "arm") server->Arm();
  if (what == "disarm") server->Disarm();
  if (what == "stop") server->EmergencyStop();
  if (what == "reset") server->ResetOutput();
  if (what == "solver") server->SetSolver(word(from));
  if (what == "backend") server->SetBackend(word(from));
  if (what == "intensity") server->SetIntensity(static_cast<float>(vector(from).X));
  if (what == "open") rest.Reset(), hand->Source = EHapticHandSource::Open, open(from);
  if (what == "mouse") mouse(from);
  if (what == "stm") volume->Technique.Kind = EHapticTechnique::STM, volume->Refresh();
  if (what == "lost") rest.Reset(), hand->SetLost();
  if (what == "handless") rest.Reset(), world->destroy(player), player = nullptr, hand = nullptr, quiet = nullptr;
  if (what == "sway") from >> sway;
  if (what == "shelf") shelf(from);
  if (what == "second") second();
  if (what == "pair") pair();
  if (what == "first") server->EndPlay(EEndPlayReason::Destroyed);
  effect(what, from);
  tell(R"({"did": ")" + what + "\"}");
}

/// Starts the server: its program, and more arguments.
void Level::serve(std::istream& from) {
  auto* settings = GetMutableDefault<UPacinianSettings>();
  settings->ServerCommand = word(from);
  for (FString each = word(from); !each.IsEmpty(); each = word(from)) settings->ServerArguments.Add(each);
  FString problem;
  server->StartServer(problem);
}

/// Moves the array, the ball, the point or the plate: position [cm], yaw [deg], scale (1 or 3 numbers). The position of
/// the array is in the level, others are above the array.
void Level::place(std::istream& from) {
  std::string what;
  double yaw = 0.0;
  FVector scale;
  from >> what;
  const FVector at = vector(from);
  from >> yaw >> scale.X;
  if (!(from >> scale.Y >> scale.Z)) scale = FVector(scale.X, scale.X, scale.X);
  USceneComponent* moved = what == "ball" ? ball : what == "array" ? static_cast<USceneComponent*>(array->Origin) : named(what);
  moved->SetRelativeTransform(FTransform(FQuat(FRotator{0.0, yaw, 0.0}), at, scale));
  tell(R"({"did": "place"})");
}

/// Places the player, who has an open hand [cm].
void Level::open(std::istream& from) {
  auto* root = player->CreateDefaultSubobject<USceneComponent>(TEXT("Root"));
  player->SetRootComponent(root);
  root->SetRelativeTransform(FTransform(array->Origin->GetComponentTransform().GetRotation(), vector(from)));
}

/// Moves the mouse: right and down from the window's upper left [pixels], and 1 if its button is down.
void Level::mouse(std::istream& from) {
  hand->Source = EHapticHandSource::Mouse;
  from >> controller->MouseX >> controller->MouseY >> controller->bMouseDown;
}

void Level::joints(std::istream& from) {
  rest.Reset();
  for (int i = 0; i < 26; ++i) rest.Add(vector(from));
  tell(R"({"did": "joints"})");
}

/// Moves the quiet zone: position in the level [cm], radius [cm] and pressure [Pa].
void Level::zone(std::istream& from) {
  quiet->SetRelativeTransform(FTransform(FQuat(), vector(from)));
  from >> quiet->Radius >> quiet->Pressure;
  tell(R"({"did": "quiet"})");
}

UHapticEffectComponent* Level::named(const std::string& name) {
  if (name == "point") return point;
  if (name == "plate") return plate;
  return volume;
}

/// Examples: `play point`, `silence ball`, `press ball 5`, `share ball 0.5`, `duration point 0.5`, `tremble ball 80`,
/// `fade ball`, `refresh ball`, `rectangle`, `disc`, `mesh 6 6 6`.
void Level::effect(const std::string& what, std::istream& from) {
  std::string name;
  if (what == "rectangle") plate->Shape = EHapticSurface::Rectangle;
  if (what == "disc") plate->Shape = EHapticSurface::Disc;
  if (what == "mesh") plate->Mesh = volume->Mesh = NewObject<UStaticMesh>(things), surface(from);
  static const std::set<std::string> known = {"play", "silence", "press", "share", "duration", "tremble", "fade", "refresh"};
  if (known.count(what) == 0) return;
  from >> name;
  UHapticEffectComponent* found = named(name);
  if (what == "play") found->Play();
  if (what == "silence") found->Stop();
  if (what == "refresh") found->Refresh();
  if (what == "press") found->SetRadiationPressure(static_cast<float>(vector(from).X));
  if (what == "share") found->SetRelativeStrength(static_cast<float>(vector(from).X));
  if (what == "duration") from >> found->Duration;
  if (what != "tremble" && what != "fade") return;
  auto* envelope = NewObject<UHapticEnvelope>(things);
  if (what == "tremble") from >> envelope->Frequency;
  if (what == "fade") {
    envelope->Kind = EHapticEnvelope::Curve;
    envelope->Curve = NewObject<UCurveFloat>(things);
    envelope->Curve->Keys = {{0.0F, 1.0F}, {0.5F, 0.5F}};
  }
  found->SetEnvelope(envelope);
}

/// Gives the volume and the plate a box mesh of this size [cm], with separate vertices for each face, like a rendered
/// mesh.
void Level::surface(std::istream& from) {
  const FVector half = 0.5 * vector(from);
  FStaticMeshLODResources level;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0F, 1.0F}) {
      const auto first = static_cast<uint32>(level.VertexBuffers.PositionVertexBuffer.Positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        float at[3];
        at[axis] = side;
        at[(axis + 1) % 3] = corner & 1 ? 1.0F : -1.0F;
        at[(axis + 2) % 3] = (corner & 2 ? 1.0F : -1.0F) * side;
        level.VertexBuffers.PositionVertexBuffer.Positions.push_back(
            {at[0] * float(half.X), at[1] * float(half.Y), at[2] * float(half.Z)});
      }
      // cross(1 - 0, 2 - 0) points inwards: seen from outside, counter-clockwise in a left-handed frame
      for (const uint32 i : {0U, 2U, 1U, 1U, 2U, 3U}) level.IndexBuffer.Indices.push_back(first + i);
    }
  volume->Mesh->Data.LODResources.Add(level);
  volume->Shape = EHapticVolume::Mesh;
  volume->Refresh();
}

/// Adds a box to the ball's collision: position [cm], side [cm] and yaw [deg]; a side of 0 removes it.
void Level::shelf(std::istream& from) {
  if (!box) {
    box = things->CreateDefaultSubobject<UPrimitiveComponent>(TEXT("Box"));
    box->SetupAttachment(ball);
  }
  const FVector at = vector(from);
  float side = 0.0F;
  double yaw = 0.0;
  from >> side >> yaw;
  const double half = yaw * 3.14159265358979323846 / 360.0;
  box->SetRelativeTransform(FTransform(FQuat(0.0, 0.0, std::sin(half), std::cos(half)), at));
  box->Body.AggGeom.BoxElems.Reset();
  if (side > 0.0F) box->Body.AggGeom.BoxElems.Add({FVector::ZeroVector, FRotator::ZeroRotator, side, side, side});
}

/// Adds a second server component, which must wait.
void Level::second() {
  AActor* actor = world->spawn<AActor>(TEXT("Rival"));
  rival = actor->CreateDefaultSubobject<UHapticServerComponent>(TEXT("Server"));
  rival->ConnectionFile = server->ConnectionFile;
  world->begin(actor);
}

/// Adds a second hand of the same side, which is open, and a second volume of the same name, in the same place.
void Level::pair() {
  AActor* actor = world->spawn<AActor>(TEXT("Pair"));
  auto* root = actor->CreateDefaultSubobject<USceneComponent>(TEXT("Root"));
  actor->SetRootComponent(root);
  root->SetupAttachment(array->Origin);
  root->SetRelativeTransform(FTransform(FQuat(), FVector(-3.0, 0.0, 21.5)));
  auto* other = actor->CreateDefaultSubobject<UHapticHandComponent>(TEXT("Hand"));
  other->Source = EHapticHandSource::Open;
  auto* same = actor->CreateDefaultSubobject<UHapticVolumeComponent>(TEXT("Volume"));
  same->SetupAttachment(ball);
  same->EffectName = volume->EffectName;
  world->begin(actor);
}

/// Prints the outline that the editor draws of an effect.
void Level::outline(std::istream& from) {
  std::string name;
  from >> name;
  TArray<FVector> lines;
  FString problem;
  const bool drawn = named(name)->GetOutline(lines, problem);
  tell(R"({"outline": )" + numbers(lines) + R"(, "drawn": )" + (drawn ? "true" : "false") + R"(, "why": )" + quoted(problem) + "}");
}

/// Aligns the array to touched corners, which are computed from a position and yaw.
void Level::align(std::istream& from) {
  const FVector at = vector(from);
  double yaw = 0.0;
  from >> yaw;
  const FTransform there(FQuat(FRotator{0.0, yaw, 0.0}), at);
  FVector next;
  FString problem;
  bool done = array->Origin->BeginAlignment();
  while (array->Origin->GetNextPoint(next)) array->Origin->TouchPoint(there.TransformPosition(next));
  const int32 touched = array->Origin->GetTouched();
  done = done && array->Origin->FinishAlignment(problem) && array->Origin->SaveCalibration();
  array->Origin->SetRelativeTransform(FTransform());
  done = done && array->Origin->LoadCalibration();
  const FTransform found = array->Origin->GetComponentTransform();
  tell(R"({"aligned": )" + std::string(done ? "true" : "false") + R"(, "touched": )" + std::to_string(touched) +
       R"(, "residual": )" + std::to_string(array->Origin->GetResidual()) + R"(, "at": )" +
       numbers({found.GetLocation(), found.GetUnitAxis(EAxis::X)}) + "}");
}

void Level::status() {
  static const char* const outputs[] = {"unknown", "silent", "sounding", "stale", "stopped", "faulted"};
  static const char* const states[] = {"stopped", "connecting", "connected", "refused"};
  TArray<FVector> places;
  TArray<float> pressures;
  array->View->GetSamples(places, pressures);
  std::ostringstream made;
  made << R"({"status": ")" << states[int(server->GetStatus())] << R"(", "output": ")" << outputs[int(server->GetOutput())]
       << R"(", "armed": )" << (server->IsArmed() ? "true" : "false") << R"(, "lease": )" << server->GetGrantedLease()
       << R"(, "latency": )" << server->GetLatency() << R"(, "solvers": )" << server->GetSolvers().Num()
       << R"(, "emitted": )" << volume->GetEmitted() << R"(, "wrong": )" << quoted(volume->GetProblem())
       << R"(, "force": )" << volume->GetRegionFelt().Force << R"(, "pointed": )" << (point->GetRegionFelt().bKnown ? "true" : "false")
       << R"(, "faulty": )" << quoted(point->GetProblem())
       << R"(, "rival": )" << quoted(rival ? rival->GetProblem() : FString()) << R"(, "rival_status": ")"
       << (rival ? states[int(rival->GetStatus())] : "") << R"(", "relative": )" << volume->GetRelativeStrength()
       << R"(, "silence": )" << quoted(server->GetSilence()) << R"(, "cause": )" << quoted(server->GetSilenceCause())
       << R"(, "touched": )" << quoted(felt.Effect) << R"(, "height": )" << felt.Position.Z
       << R"(, "screen": )" << quoted(GEngine->StubScreen) << R"(, "cursor": )" << (controller->bShowMouseCursor ? "true" : "false")
       << R"(, "drawn": )" << StubDrawn << R"(, "playing": )" << (point->IsPlaying() ? "true" : "false")
       << R"(, "samples": )" << numbers(places) << R"(, "problem": )" << quoted(server->GetProblem()) << "}";
  tell(made.str());
}
