#pragma once

// Stubs of vectors, rotations and transforms, with the engine's conventions.

#include <cmath>

#include "text.h"

struct FMath {
  static int32 RoundToInt32(double Value) { return static_cast<int32>(std::lround(Value)); }
  template <class T>
  static T Clamp(T Value, T Low, T High) {
    return Value < Low ? Low : Value < High ? Value : High;
  }
  static double Clamp(double Value, double Low, double High) { return Clamp<double>(Value, Low, High); }
  template <class T>
  static T Max(T A, T B) {
    return A < B ? B : A;
  }
  static double Max(double A, double B) { return Max<double>(A, B); }
  template <class T>
  static T Min(T A, T B) {
    return A < B ? A : B;
  }
  template <class T>
  static T Abs(T A) {
    return A < T(0) ? -A : A;
  }
};

struct FVector {
  double X = 0.0, Y = 0.0, Z = 0.0;
  FVector() = default;
  FVector(double x, double y, double z) : X(x), Y(y), Z(z) {}
  template <class T>
  explicit FVector(const T& Given) : X(Given.X), Y(Given.Y), Z(Given.Z) {}
  double Size() const { return std::sqrt(X * X + Y * Y + Z * Z); }
  double GetAbsMin() const { return std::min({std::abs(X), std::abs(Y), std::abs(Z)}); }
  bool ContainsNaN() const { return !(std::isfinite(X) && std::isfinite(Y) && std::isfinite(Z)); }
  bool Equals(const FVector& Other, double Most) const {
    return std::abs(X - Other.X) <= Most && std::abs(Y - Other.Y) <= Most && std::abs(Z - Other.Z) <= Most;
  }
  friend FVector operator+(const FVector& A, const FVector& B) { return {A.X + B.X, A.Y + B.Y, A.Z + B.Z}; }
  friend FVector operator-(const FVector& A, const FVector& B) { return {A.X - B.X, A.Y - B.Y, A.Z - B.Z}; }
  friend FVector operator*(const FVector& A, const FVector& B) { return {A.X * B.X, A.Y * B.Y, A.Z * B.Z}; }
  friend FVector operator*(double S, const FVector& A) { return {S * A.X, S * A.Y, S * A.Z}; }
  static const FVector ZeroVector, OneVector;
};
inline const FVector FVector::ZeroVector{}, FVector::OneVector{1.0, 1.0, 1.0};

struct FVector3f {
  float X = 0.0F, Y = 0.0F, Z = 0.0F;
  friend bool operator<(const FVector3f& A, const FVector3f& B) {
    return A.X != B.X ? A.X < B.X : A.Y != B.Y ? A.Y < B.Y : A.Z < B.Z;
  }
};
struct FVector2D {
  double X = 0.0, Y = 0.0;
  FVector2D(double x, double y) : X(x), Y(y) {}
};

struct FRotator {
  double Pitch = 0.0, Yaw = 0.0, Roll = 0.0;
  static const FRotator ZeroRotator;
};
inline const FRotator FRotator::ZeroRotator{};

struct FQuat {
  double X = 0.0, Y = 0.0, Z = 0.0, W = 1.0;
  FQuat() = default;
  FQuat(double x, double y, double z, double w) : X(x), Y(y), Z(z), W(w) {}
  explicit FQuat(const FRotator& Given) {
    const double h = 3.14159265358979323846 / 360.0;
    const double sp = std::sin(h * Given.Pitch), cp = std::cos(h * Given.Pitch);
    const double sy = std::sin(h * Given.Yaw), cy = std::cos(h * Given.Yaw);
    const double sr = std::sin(h * Given.Roll), cr = std::cos(h * Given.Roll);
    X = cr * sp * sy - sr * cp * cy;
    Y = -cr * sp * cy - sr * cp * sy;
    Z = cr * cp * sy - sr * sp * cy;
    W = cr * cp * cy + sr * sp * sy;
  }
  FQuat Inverse() const { return {-X, -Y, -Z, W}; }
  FVector RotateVector(const FVector& V) const {
    const FVector t = 2.0 * FVector(Y * V.Z - Z * V.Y, Z * V.X - X * V.Z, X * V.Y - Y * V.X);
    return V + W * t + FVector(Y * t.Z - Z * t.Y, Z * t.X - X * t.Z, X * t.Y - Y * t.X);
  }
  /// Returns the rotation B followed by A.
  friend FQuat operator*(const FQuat& A, const FQuat& B) {
    return {A.W * B.X + A.X * B.W + A.Y * B.Z - A.Z * B.Y, A.W * B.Y - A.X * B.Z + A.Y * B.W + A.Z * B.X,
            A.W * B.Z + A.X * B.Y - A.Y * B.X + A.Z * B.W, A.W * B.W - A.X * B.X - A.Y * B.Y - A.Z * B.Z};
  }
};

namespace EAxis {
enum Type { None, X, Y, Z };
}

class FTransform {
 public:
  FTransform() = default;
  FTransform(const FQuat& rotation, const FVector& place, const FVector& scale = FVector::OneVector)
      : Turn(rotation), Place(place), Scale(scale) {}
  FTransform(const FRotator& rotation, const FVector& place) : Turn(rotation), Place(place) {}
  const FQuat& GetRotation() const { return Turn; }
  void SetRotation(const FQuat& Given) { Turn = Given; }
  const FVector& GetLocation() const { return Place; }
  const FVector& GetScale3D() const { return Scale; }
  FVector TransformPosition(const FVector& Given) const { return Turn.RotateVector(Scale * Given) + Place; }
  FVector TransformPositionNoScale(const FVector& Given) const { return Turn.RotateVector(Given) + Place; }
  FVector InverseTransformPosition(const FVector& Given) const {
    const FVector V = Turn.Inverse().RotateVector(Given - Place);
    return {V.X / Scale.X, V.Y / Scale.Y, V.Z / Scale.Z};
  }
  FVector GetUnitAxis(EAxis::Type Axis) const {
    return Turn.RotateVector({double(Axis == EAxis::X), double(Axis == EAxis::Y), double(Axis == EAxis::Z)});
  }
  FTransform GetRelativeTransform(const FTransform& To) const {
    return {To.Turn.Inverse() * Turn, To.InverseTransformPosition(Place),
            {Scale.X / To.Scale.X, Scale.Y / To.Scale.Y, Scale.Z / To.Scale.Z}};
  }
  /// Returns the transform A followed by B.
  friend FTransform operator*(const FTransform& A, const FTransform& B) {
    return {B.Turn * A.Turn, B.TransformPosition(A.Place), A.Scale * B.Scale};
  }
  static const FTransform Identity;

 private:
  FQuat Turn;
  FVector Place, Scale = FVector::OneVector;
};
inline const FTransform FTransform::Identity{};

struct FColor {
  uint8 R = 0, G = 0, B = 0;
  static const FColor Cyan, White;
};
inline const FColor FColor::Cyan{0, 255, 255}, FColor::White{255, 255, 255};
struct FLinearColor {
  float R = 0.0F, G = 0.0F, B = 0.0F;
  FColor ToFColor(bool) const { return {uint8(255 * R), uint8(255 * G), uint8(255 * B)}; }
  static FLinearColor LerpUsingHSV(const FLinearColor& A, const FLinearColor& B, float) { return {A.R, A.G, B.B}; }
  static const FLinearColor Red, Green, Blue, Yellow;
};
inline const FLinearColor FLinearColor::Red{1, 0, 0}, FLinearColor::Green{0, 1, 0}, FLinearColor::Blue{0, 0, 1},
    FLinearColor::Yellow{1, 1, 0};
