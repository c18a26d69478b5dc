#pragma once

// Stubs of the engine's text and containers, as far as the plugin uses them, over the standard library.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

using int32 = std::int32_t;
using uint32 = std::uint32_t;
using uint64 = std::uint64_t;
using uint8 = std::uint8_t;
using TCHAR = char16_t;

#define TEXT(x) u##x
#define THIRD_PARTY_INCLUDES_START
#define THIRD_PARTY_INCLUDES_END
#define WITH_EDITOR 1
#define ENABLE_DRAW_DEBUG 1
#define PLATFORM_WINDOWS 0
#define UE_BUILD_SHIPPING 0
#define UE_DOUBLE_PI (3.141592653589793238462643383279502884)

template <class T>
std::remove_reference_t<T>&& MoveTemp(T&& Given) {
  static_assert(std::is_lvalue_reference_v<T> && !std::is_const_v<std::remove_reference_t<T>>, "nothing is moved");
  return static_cast<std::remove_reference_t<T>&&>(Given);
}

namespace stub {
std::string utf8(const TCHAR* given);
std::u16string utf16(const char* given);
}  // namespace stub

struct FUTF8ToTCHAR {
  explicit FUTF8ToTCHAR(const char* Given) : Made(stub::utf16(Given)) {}
  const TCHAR* Get() const { return Made.c_str(); }
  std::u16string Made;
};
struct FTCHARToUTF8 {
  explicit FTCHARToUTF8(const TCHAR* Given) : Made(stub::utf8(Given)) {}
  const char* Get() const { return Made.c_str(); }
  std::string Made;
};
#define UTF8_TO_TCHAR(x) FUTF8ToTCHAR(x).Get()
#define TCHAR_TO_UTF8(x) FTCHARToUTF8(x).Get()

namespace ESearchCase {
enum Type { CaseSensitive, IgnoreCase };
}

class FString {
 public:
  FString() = default;
  FString(const TCHAR* Given) : Made(Given) {}
  const TCHAR* operator*() const { return Made.c_str(); }
  bool IsEmpty() const { return Made.empty(); }
  void Reset() { Made.clear(); }
  /// The engine's function ignores case by default.
  bool StartsWith(const FString& Given, ESearchCase::Type) const { return Made.rfind(Given.Made, 0) == 0; }
  FString Left(int32 Count) const { return Made.substr(0, Count); }
  FString Right(int32 Count) const { return Made.size() <= std::size_t(Count) ? Made : Made.substr(Made.size() - Count); }
  friend FString operator+(const FString& A, const FString& B) { return A.Made + B.Made; }
  friend bool operator==(const FString& A, const FString& B) { return A.Made == B.Made; }
  friend bool operator<(const FString& A, const FString& B) { return A.Made < B.Made; }

  template <class... Values>
  static FString Printf(const TCHAR* Format, Values... Given) {
    return Filled(stub::utf8(Format), {One(Given)...});
  }

 private:
  FString(std::u16string Given) : Made(std::move(Given)) {}
  static std::string One(const TCHAR* Given) { return stub::utf8(Given); }
  static std::string One(double Given) { return std::to_string(Given); }
  static std::string One(int32 Given) { return std::to_string(Given); }
  static FString Filled(const std::string& Format, const std::vector<std::string>& Values);

  std::u16string Made;
};

using FName = FString;

class FText {
 public:
  static FText FromString(FString Given) { return FText(std::move(Given)); }
  static FText AsNumber(double Given) { return FText(FString::Printf(TEXT("%s"), Given)); }
  template <class... Values>
  static FText Format(FText Pattern, Values...) {
    return Pattern;
  }
  FText() = default;
  const FString& ToString() const { return Made; }

 private:
  explicit FText(FString Given) : Made(std::move(Given)) {}
  FString Made;
};
#define LOCTEXT(key, text) FText::FromString(FString(TEXT(text)))

template <class T>
class TArray {
 public:
  TArray() = default;
  TArray(std::initializer_list<T> Given) : Made(Given) {}
  int32 Num() const { return static_cast<int32>(Made.size()); }
  void Add(T Given) { Made.push_back(std::move(Given)); }
  void AddUnique(T Given) {
    if (std::find(Made.begin(), Made.end(), Given) == Made.end()) Made.push_back(std::move(Given));
  }
  template <class U>
  void Remove(const U& Given) {
    Made.erase(std::remove(Made.begin(), Made.end(), Given), Made.end());
  }
  void Reset() { Made.clear(); }
  T& Last() { return Made.back(); }
  T& operator[](int32 i) { return Made.at(i); }
  const T& operator[](int32 i) const { return Made.at(i); }
  bool operator==(const TArray& Other) const { return Made == Other.Made; }
  auto begin() const { return Made.begin(); }
  auto end() const { return Made.end(); }

 private:
  std::vector<T> Made;
};
template <class T>
using TInlineComponentArray = TArray<T>;

template <class K, class V>
class TMap {
 public:
  int32 Num() const { return static_cast<int32>(Made.size()); }
  void Add(const K& Key, V Value) { Made[Key] = std::move(Value); }
  const V* Find(const K& Key) const {
    const auto Found = Made.find(Key);
    return Found == Made.end() ? nullptr : &Found->second;
  }

 private:
  std::map<K, V> Made;
};

struct FStubCategory {};
#define DECLARE_LOG_CATEGORY_EXTERN(Name, Default, Most) extern FStubCategory Name
#define DEFINE_LOG_CATEGORY(Name) FStubCategory Name
#define DEFINE_LOG_CATEGORY_STATIC(Name, Default, Most) static FStubCategory Name
#define UE_LOG(Category, Verbosity, ...)                                                      \
  do {                                                                                        \
    (void)Category;                                                                           \
    std::fprintf(stderr, #Verbosity ": %s\n", stub::utf8(*FString::Printf(__VA_ARGS__)).c_str()); \
  } while (false)
