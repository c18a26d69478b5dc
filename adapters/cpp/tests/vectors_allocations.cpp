// Messages that are sent and read each frame must not allocate again, and malformed bytes must allocate little.

#include <cstdio>
#include <cstdlib>
#include <new>

#include "pacinian/wire/bulk.h"
#include "vectors_files.h"

namespace {

std::size_t allocated_bytes = 0, allocations = 0;

void* counted(std::size_t size) {
  allocated_bytes += size;
  ++allocations;
  void* made = std::malloc(size ? size : 1);
  if (!made) std::abort();
  return made;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* made) noexcept { std::free(made); }
void operator delete[](void* made) noexcept { std::free(made); }
void operator delete(void* made, std::size_t) noexcept { std::free(made); }
void operator delete[](void* made, std::size_t) noexcept { std::free(made); }

namespace {

using namespace pacinian::wire;

constexpr int frames = 100;
int failed = 0;

void expect(bool good, const char* what, std::size_t found) {
  if (good) return;
  ++failed;
  std::printf("%s: %zu\n", what, found);
}

/// Checks that only the first of many calls allocates.
template <class F>
void steady(const char* what, F once) {
  once(0);
  const std::size_t before = allocations;
  for (int i = 1; i < frames; ++i) once(i);
  expect(allocations == before, what, allocations - before);
}

void numbers(Bytes& to, std::size_t count, int frame) {
  to.clear();
  for (std::size_t i = 0; i < count; ++i) append(to, 0.001F * static_cast<float>(frame));
}

void written() {
  Writer out;
  Move move;
  move.session.assign(16, 1);
  move.names = {"a ball that is held by the left hand", "a table", "b"};
  steady("allocations of move", [&](int frame) {
    move.sequence = 1 + frame * 1000;
    numbers(move.poses, 21, frame);
    numbers(move.velocities, 18, frame);
    encode(move, out, MAX_COMMAND_BYTES);
  });
  Hands hands;
  hands.session.assign(16, 1);
  hands.hands.resize(2);
  steady("allocations of hands", [&](int frame) {
    hands.sequence = 1 + frame;
    for (HandFrame& hand : hands.hands) {
      numbers(hand.joints, 78, frame);
      numbers(hand.radii, 26, frame);
      numbers(hand.velocities, 3, frame);
    }
    encode(hands, out, MAX_COMMAND_BYTES);
  });
  Renew renew;
  renew.session.assign(16, 1);
  steady("allocations of renew", [&](int frame) {
    renew.id = renew.sequence = 1 + frame;
    encode(renew, out, MAX_CONTROL_BYTES);
  });
}

void read_again(const std::string& folder) {
  WireError error;
  for (const auto& vector : vectors::read(folder, "state")) {
    AnyState state;
    steady("allocations of a state", [&](int) {
      expect(decode_state(vector.data.data(), vector.data.size(), state, error), vector.name.c_str(), 0);
    });
  }
  for (const auto& vector : vectors::read(folder, "reply")) {
    if (vector.name != "renewed" && vector.name != "ok") continue;
    AnyReply reply;
    steady("allocations of a reply", [&](int) {
      expect(decode_reply(vector.data.data(), vector.data.size(), reply, error), vector.name.c_str(), 0);
    });
  }
}

void refused(const std::string& folder) {
  vectors::Bytes made;
  for (const auto& vector : vectors::read(folder, "malformed")) {
    vectors::Sockets sockets;
    const std::size_t before = allocated_bytes;
    sockets.again(vector.socket, vector.data, made);
    expect(allocated_bytes - before <= 4096 + 64 * vector.data.size(), vector.name.c_str(), allocated_bytes - before);
  }
}

}  // namespace

int main(int count, char** arguments) {
  const std::string folder = count > 1 ? arguments[1] : "tests/wire";
  if (vectors::read(folder, "state").empty()) return 1;
  written();
  read_again(folder);
  refused(folder);
  std::printf("%d failed\n", failed);
  return failed == 0 ? 0 : 1;
}
