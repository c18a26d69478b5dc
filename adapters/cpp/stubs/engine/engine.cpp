#include <algorithm>

#include "assets.h"

UEngine* GEngine = nullptr;
int StubDrawn = 0;

namespace stub {

std::string utf8(const TCHAR* given) {
  std::string made;
  while (*given) {
    std::uint32_t c = *given++;
    if (c >= 0xd800 && c < 0xdc00 && *given) c = 0x10000 + ((c - 0xd800) << 10) + (*given++ - 0xdc00U);
    if (c < 0x80) {
      made += static_cast<char>(c);
      continue;
    }
    const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    made += static_cast<char>((0xf00 >> more & 0xff) | c >> 6 * more);
    for (int i = more - 1; i >= 0; --i) made += static_cast<char>(0x80 | (c >> 6 * i & 0x3f));
  }
  return made;
}

std::u16string utf16(const char* given) {
  std::u16string made;
  while (*given) {
    std::uint32_t c = static_cast<unsigned char>(*given++);
    const int more = c < 0x80 ? 0 : c < 0xe0 ? 1 : c < 0xf0 ? 2 : 3;
    if (more) c &= 0x3f >> more;
    for (int i = 0; i < more && *given; ++i) c = c << 6 | (static_cast<unsigned char>(*given++) & 0x3f);
    if (c >= 0x10000) {
      made += static_cast<char16_t>(0xd800 + ((c - 0x10000) >> 10));
      c = 0xdc00 + ((c - 0x10000) & 0x3ff);
    }
    made += static_cast<char16_t>(c);
  }
  return made;
}

}  // namespace stub

FString FString::Filled(const std::string& Format, const std::vector<std::string>& Values) {
  std::string made;
  std::size_t next = 0;
  for (std::size_t i = 0; i < Format.size(); ++i)
    if (Format[i] == '%' && next < Values.size())
      made += Values[next++], ++i;
    else
      made += Format[i];
  return stub::utf16(made.c_str());
}

AActor::~AActor() {
  for (UActorComponent* Each : Components) delete Each;
}

UWorld::~UWorld() {
  for (AActor* Each : actors_) delete Each;
  for (UObject* Each : subsystems_) delete Each;
}

void UWorld::begin(AActor* Actor) {
  for (UActorComponent* Each : Actor->Components)
    if (Each->bAutoActivate) Each->Activate(true);
  for (UActorComponent* Each : Actor->Components) Each->BeginPlay();
}

void UWorld::tick(float DeltaTime) {
  time_ += DeltaTime;
  for (const ETickingGroup Group : {TG_PrePhysics, TG_PostUpdateWork}) {
    std::vector<UActorComponent*> All;
    for (const AActor* Actor : actors_) All.insert(All.end(), Actor->Components.begin(), Actor->Components.end());
    for (UActorComponent* Each : All)
      if (UObject::All().count(Each) && Each->HasBegunPlay() && Each->PrimaryComponentTick.bCanEverTick &&
          Each->PrimaryComponentTick.TickGroup == Group)
        Each->TickComponent(DeltaTime, LEVELTICK_All, &Each->PrimaryComponentTick);
  }
}

void UWorld::end(AActor* Actor, EEndPlayReason::Type Reason) {
  for (UActorComponent* Each : Actor->Components)
    if (Each->HasBegunPlay()) Each->EndPlay(Reason);
  for (UActorComponent* Each : Actor->Components) Each->BeginDestroy();
}

void UWorld::end(EEndPlayReason::Type Reason) {
  while (!actors_.empty()) {
    end(actors_.back(), Reason);
    delete actors_.back();
    actors_.pop_back();
  }
}

void UWorld::destroy(AActor* Actor) {
  end(Actor, EEndPlayReason::Destroyed);
  actors_.erase(std::find(actors_.begin(), actors_.end(), Actor));
  delete Actor;
}
