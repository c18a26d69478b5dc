#pragma once

#include <cstdlib>
#include <new>

namespace example {

/// The thread whose calls of `operator new` are counted.
enum Thread { others, game, worker };

inline thread_local Thread thread = others;
inline long allocations[3] = {};  // one thread writes each, except that of `others`

}  // namespace example

// Defines operators for the whole program: include it in only one source.

void* operator new(std::size_t size) {
  if (example::thread != example::others) ++example::allocations[example::thread];
  void* made = std::malloc(size > 0 ? size : 1);
  if (!made) std::abort();
  return made;
}

void operator delete(void* memory) noexcept { std::free(memory); }

void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
