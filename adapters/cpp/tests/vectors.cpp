// Reads every byte vector and writes it again. Malformed ones must be rejected with the path that Python gives.

#include <cstdio>

#include "vectors_files.h"

int main(int count, char** arguments) {
  const std::string folder = count > 1 ? arguments[1] : "tests/wire";
  int passed = 0, failed = 0;
  const auto expect = [&](bool good, const vectors::Vector& vector, const std::string& told) {
    ++(good ? passed : failed);
    if (!good)
      std::printf("%s: %s: %s\n", vector.socket.c_str(), vector.name.c_str(), told.c_str());
  };
  vectors::Sockets used;
  for (const auto& vector : vectors::valid(folder)) {
    vectors::Sockets fresh;
    for (vectors::Sockets* sockets : {&fresh, &used, &used}) {
      vectors::Bytes made;
      const bool good = sockets->again(vector.socket, vector.data, made);
      expect(good, vector, sockets->error.path + " " + sockets->error.problem);
      if (good) expect(made == vector.meant, vector, "written as " + vectors::hex(made));
    }
  }
  for (const auto& vector : vectors::read(folder, "malformed")) {
    vectors::Bytes made;
    expect(!used.again(vector.socket, vector.data, made), vector, "not refused");
    expect(used.error.path == vector.path, vector, used.error.path + ", not " + vector.path);
    expect(!used.error.problem.empty(), vector, "no reason");
  }
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 && passed > 0 ? 0 : 1;
}
