#include "Outline.h"

#include <cmath>

namespace wire = pacinian::wire;

namespace Haptic {

namespace {

using pacinian::Vec3;

constexpr int Segments = 32;           // of a circle
constexpr std::size_t MostFaces = 3000;  // of a mesh; beyond that, some faces are left out
constexpr Vec3 X{1.0, 0.0, 0.0}, Y{0.0, 1.0, 0.0}, Z{0.0, 0.0, 1.0};

/// Draws each shape in its frame, except shapes that no component has.
struct FPen {
  pacinian::Rigid Frame;
  TArray<FVector>& Lines;

  void Line(const Vec3& A, const Vec3& B) const {
    for (const Vec3& End : {A, B}) Lines.Add(Vec(pacinian::unreal::from_world(pacinian::apply(Frame, End))));
  }

  void Circle(double Radius, const Vec3& U, const Vec3& V, const Vec3& Middle = {}) const {
    const auto At = [&](int i) {
      const double Angle = 2.0 * UE_DOUBLE_PI * i / Segments;
      return Middle + Radius * (std::cos(Angle) * U + std::sin(Angle) * V);
    };
    for (int i = 0; i < Segments; ++i) Line(At(i), At(i + 1));
  }

  void Ball(double Radius, const Vec3& Middle = {}) const {
    Circle(Radius, X, Y, Middle);
    Circle(Radius, Y, Z, Middle);
    Circle(Radius, Z, X, Middle);
  }

  template <class T>
  void operator()(const T&) const {}

  void operator()(const wire::Point& Given) const { Ball(std::sqrt(Given.area / UE_DOUBLE_PI)); }
  void operator()(const wire::Surface& Given) const { std::visit(*this, Given.shape); }
  void operator()(const wire::Volume& Given) const { std::visit(*this, Given.shape); }
  void operator()(const wire::Sphere& Given) const { Ball(Given.radius); }
  void operator()(const wire::Disc& Given) const { Circle(Given.radius, X, Y); }

  void operator()(const wire::Rectangle& Given) const {
    const Vec3 U = 0.5 * Given.width * X, V = 0.5 * Given.height * Y;
    const Vec3 Corners[] = {U + V, U - V, -1.0 * (U + V), V - U};
    for (int i = 0; i < 4; ++i) Line(Corners[i], Corners[(i + 1) % 4]);
  }

  void operator()(const wire::Box& Given) const {
    const auto At = [&](int Corner) {
      const auto Side = [&](int Axis) { return Given.size[static_cast<std::size_t>(Axis)] * (Corner >> Axis & 1 ? 0.5 : -0.5); };
      return Vec3{Side(0), Side(1), Side(2)};
    };
    for (int Corner = 0; Corner < 8; ++Corner)
      for (int Axis = 0; Axis < 3; ++Axis)
        if (!(Corner >> Axis & 1)) Line(At(Corner), At(Corner | 1 << Axis));
  }

  void operator()(const wire::Capsule& Given) const {
    const Vec3 End = 0.5 * Given.length * Z;
    Ball(Given.radius, End);
    Ball(Given.radius, -1.0 * End);
    for (const Vec3& Side : {X, Y, -1.0 * X, -1.0 * Y}) Line(Given.radius * Side + End, Given.radius * Side - End);
  }

  void operator()(const wire::Mesh& Given) const {
    const std::size_t Faces = Given.faces.size() / 12;
    for (std::size_t i = 0; i < Faces; i += 1 + Faces / MostFaces) {
      const auto At = [&](std::size_t Corner) {
        const std::size_t First = 3 * static_cast<std::size_t>(wire::uint32_at(Given.faces, 3 * i + Corner % 3));
        return Vec3{wire::float_at(Given.vertices, First), wire::float_at(Given.vertices, First + 1),
                    wire::float_at(Given.vertices, First + 2)};
      };
      for (std::size_t Corner = 0; Corner < 3; ++Corner) Line(At(Corner), At(Corner + 1));
    }
  }

  void operator()(const wire::Placed& Given) const {
    const auto& [Position, Rotation] = Given.pose;
    const pacinian::Rigid Inside{{Position[0], Position[1], Position[2]}, {Rotation[0], Rotation[1], Rotation[2], Rotation[3]}};
    std::visit(FPen{Frame * Inside, Lines}, Given.shape);
  }

  void operator()(const wire::Union& Given) const {
    for (const wire::Piece& Part : Given.parts) std::visit(*this, Part);
  }
};

}  // namespace

void AddOutline(const wire::Object& Object, const pacinian::Rigid& Frame, TArray<FVector>& Lines) {
  std::visit(FPen{Frame, Lines}, Object);
}

}  // namespace Haptic
