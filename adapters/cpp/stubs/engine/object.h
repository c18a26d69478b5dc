#pragma once

// Stubs of objects, pointers and delegates. For reflection, tests/adapters/unreal.py replaces the engine's header tool.

#include <cstdint>
#include <functional>
#include <memory>
#include <set>

#include "maths.h"

#define CURRENT_FILE_ID NONE
#define STUB_JOIN_INNER(a, b, c, d) a##b##c##d
#define STUB_JOIN(a, b, c, d) STUB_JOIN_INNER(a, b, c, d)
#define GENERATED_BODY(...) STUB_JOIN(CURRENT_FILE_ID, _, __LINE__, _GENERATED_BODY)
#define UCLASS(...)
#define USTRUCT(...)
#define UENUM(...)
#define UPROPERTY(...)
#define UFUNCTION(...)
#define PURE_VIRTUAL(name, ...) \
  { __VA_ARGS__ }
#define PACINIAN_API
#define GET_MEMBER_NAME_CHECKED(type, member) ((void)sizeof(&type::member), FName(TEXT(#member)))

/// The content of GENERATED_BODY in the class `type`.
#define STUB_BODY(type, base)                                  \
 public:                                                       \
  using Super = base;                                          \
  using ThisClass = type;                                      \
  static UClass* StaticClass() {                               \
    static UClass Made(TEXT(#type), Super::StaticClass());     \
    return &Made;                                              \
  }                                                            \
  UClass* GetClass() const override { return StaticClass(); }

class UClass {
 public:
  UClass(const TCHAR* Given, UClass* Above) : Name(Given), Base(Above) {}
  FName GetFName() const { return Name; }
  bool IsChildOf(const UClass* Other) const { return this == Other || (Base && Base->IsChildOf(Other)); }

 private:
  FName Name;
  UClass* Base;
};

struct FPropertyChangedEvent {
  FName GetPropertyName() const { return Name; }
  FName Name;
};

class UWorld;

class UObject {
 public:
  UObject() { All().insert(this); }
  virtual ~UObject() { All().erase(this); }
  UObject(const UObject&) = delete;
  UObject& operator=(const UObject&) = delete;
  static UClass* StaticClass() {
    static UClass Made(TEXT("UObject"), nullptr);
    return &Made;
  }
  virtual UClass* GetClass() const { return StaticClass(); }
  virtual UWorld* GetWorld() const { return Outer ? Outer->GetWorld() : nullptr; }
  FString GetName() const { return Name; }
  /// Default objects of classes have no owner here.
  bool IsTemplate() const { return !Outer; }
  virtual void BeginDestroy() {}
  virtual void PostEditChangeProperty(FPropertyChangedEvent&) {}

  static std::set<UObject*>& All() {
    static std::set<UObject*> Made;
    return Made;
  }
  FString Name;
  UObject* Outer = nullptr;
};

inline bool UObjectInitialized() { return true; }

template <class T, class U>
T* Cast(U* Given) {
  return Given && Given->GetClass()->IsChildOf(T::StaticClass()) ? static_cast<T*>(Given) : nullptr;
}
template <class T, class U>
const T* Cast(const U* Given) {
  return Given && Given->GetClass()->IsChildOf(T::StaticClass()) ? static_cast<const T*>(Given) : nullptr;
}

template <class T>
T* NewObject(UObject* Outer) {
  T* Made = new T();
  Made->Outer = Outer;
  return Made;
}

template <class T>
T* GetMutableDefault() {
  static T Made;
  return &Made;
}
template <class T>
const T* GetDefault() {
  return GetMutableDefault<T>();
}

template <class T>
class TObjectPtr {
 public:
  TObjectPtr(T* Given = nullptr) : Held(Given) {}
  T* Get() const { return Held; }
  T* operator->() const { return Held; }
  T& operator*() const { return *Held; }
  operator T*() const { return Held; }

 private:
  T* Held;
};

template <class T>
class TWeakObjectPtr {
 public:
  TWeakObjectPtr(T* Given = nullptr) : Held(Given) {}
  bool IsValid() const { return Held && UObject::All().count(Held) > 0; }
  T* Get() const { return IsValid() ? Held : nullptr; }
  T* operator->() const { return Get(); }

 private:
  T* Held;
};

/// Visits all objects except the classes' default objects.
template <class T>
class TObjectIterator {
 public:
  TObjectIterator() {
    for (UObject* Each : UObject::All())
      if (Each->Outer && Each->GetClass()->IsChildOf(T::StaticClass())) Found.push_back(static_cast<T*>(Each));
  }
  explicit operator bool() const { return At < Found.size(); }
  void operator++() { ++At; }
  T* operator->() const { return Found[At]; }

 private:
  std::vector<T*> Found;
  std::size_t At = 0;
};

struct UEnum {
  template <class T>
  static FText GetDisplayValueAsText(T Value) {
    return FText::AsNumber(static_cast<int>(Value));
  }
};

template <class T>
class TSharedPtr {
 public:
  TSharedPtr(std::nullptr_t = nullptr) {}
  template <class U>
  TSharedPtr(std::shared_ptr<U> Given) : Held(std::move(Given)) {}
  T* Get() const { return Held.get(); }
  T* operator->() const { return Held.get(); }
  T& operator*() const { return *Held; }
  bool IsValid() const { return Held != nullptr; }
  explicit operator bool() const { return IsValid(); }
  void Reset() { Held.reset(); }
  friend bool operator==(const TSharedPtr& A, const TSharedPtr& B) { return A.Held == B.Held; }
  friend bool operator!=(const TSharedPtr& A, const TSharedPtr& B) { return A.Held != B.Held; }

 private:
  std::shared_ptr<T> Held;
};
template <class T>
using TSharedRef = TSharedPtr<T>;
template <class T, class... Args>
std::shared_ptr<T> MakeShared(Args&&... Given) {
  return std::make_shared<T>(std::forward<Args>(Given)...);
}

using FDelegateHandle = int;

template <class... Args>
class TStubDelegate {
 public:
  void Add(std::function<void(Args...)> Given) { Told.push_back(std::move(Given)); }
  template <class T>
  void AddDynamic(T* Object, void (T::*Method)(Args...)) {
    Add([Object, Method](Args... Given) { (Object->*Method)(Given...); });
  }
  void Broadcast(Args... Given) const {
    for (const auto& Each : Told) Each(Given...);
  }

 private:
  std::vector<std::function<void(Args...)>> Told;
};
#define DECLARE_DYNAMIC_MULTICAST_DELEGATE(Name) using Name = TStubDelegate<>
#define DECLARE_DYNAMIC_MULTICAST_DELEGATE_OneParam(Name, A, a) using Name = TStubDelegate<A>
#define DECLARE_DYNAMIC_MULTICAST_DELEGATE_TwoParams(Name, A, a, B, b) using Name = TStubDelegate<A, B>
#define DECLARE_DYNAMIC_MULTICAST_DELEGATE_ThreeParams(Name, A, a, B, b, C, c) using Name = TStubDelegate<A, B, C>

class FSimpleMulticastDelegate {
 public:
  struct FDelegate {
    template <class T>
    static FDelegate CreateRaw(T*, void (T::*)()) {
      return {};
    }
  };
  template <class T>
  FDelegateHandle AddUObject(T* Object, void (T::*Method)()) {
    Told[++Last] = [Object, Method] { (Object->*Method)(); };
    return Last;
  }
  void Remove(FDelegateHandle Handle) { Told.erase(Handle); }
  void Broadcast() const {
    for (const auto& Each : Told) Each.second();
  }

 private:
  std::map<FDelegateHandle, std::function<void()>> Told;
  FDelegateHandle Last = 0;
};
struct FCoreDelegates {
  static inline FSimpleMulticastDelegate OnEnginePreExit;
};

class IModuleInterface {
 public:
  virtual ~IModuleInterface() = default;
  virtual void StartupModule() {}
  virtual void ShutdownModule() {}
};
/// Defines a module with this name; the test creates it.
#define IMPLEMENT_MODULE(type, name) \
  IModuleInterface* StubModule##name() { return new type(); }
