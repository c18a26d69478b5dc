#pragma once

#include <cstdio>

namespace check {

inline int passed = 0, failed = 0;

inline void expect(bool good, const char* what, int line) {
  ++(good ? passed : failed);
  if (!good) std::printf("line %d: not so: %s\n", line, what);
}

inline int result() {
  std::printf("%d passed, %d failed\n", passed, failed);
  return failed == 0 && passed > 0 ? 0 : 1;
}

}  // namespace check

#define EXPECT(what) check::expect((what), #what, __LINE__)
