// Seeded mutations of the byte vectors: each must be rejected with a path, or give a message that is the same when
// written again.

#include <cstdio>
#include <cstdlib>
#include <random>

#include "vectors_files.h"

namespace {

using vectors::Bytes;
using vectors::Vector;

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t most) { return most ? random_() % most : 0; }

  /// Changes, cuts out or repeats a few bytes, or takes some from another message.
  Bytes mutate(const std::vector<Vector>& all) {
    static constexpr std::uint8_t heads[] = {0xC0, 0xC1, 0xC4, 0xC6, 0xC7, 0xC9, 0xCB, 0xCF, 0xD3,
                                             0xD9, 0xDB, 0xDC, 0xDD, 0xDE, 0xDF, 0xFF, 0x7F, 0x80};
    Bytes data = all[below(all.size())].data;
    for (std::size_t left = 1 + below(4); left > 0 && !data.empty(); --left) {
      const std::size_t at = below(data.size());
      const auto here = data.begin() + static_cast<std::ptrdiff_t>(at);
      switch (below(6)) {
        case 0:
          data[at] = static_cast<std::uint8_t>(random_());
          break;
        case 1:
          data[at] = heads[below(sizeof heads)];
          break;
        case 2:
          data[at] = static_cast<std::uint8_t>(data[at] ^ (1u << below(8)));
          break;
        case 3:
          data.erase(here, here + static_cast<std::ptrdiff_t>(below(data.size() - at)));
          break;
        case 4:
          data.insert(here, 1 + below(4), heads[below(sizeof heads)]);
          break;
        default: {
          const Bytes& other = all[below(all.size())].data;
          const std::size_t from = below(other.size());
          data.resize(at);
          data.insert(data.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
        }
      }
    }
    return data;
  }

 private:
  std::mt19937 random_;
};

}  // namespace

int main(int count, char** arguments) {
  const std::string folder = count > 1 ? arguments[1] : "tests/wire";
  const int runs = count > 2 ? std::atoi(arguments[2]) : 50000;
  const unsigned seed = count > 3 ? static_cast<unsigned>(std::atoi(arguments[3])) : 1;
  const std::vector<Vector> all = vectors::valid(folder);
  if (all.empty()) return 1;
  Mutator mutator(seed);
  vectors::Sockets used;
  int understood = 0, wrong = 0;
  for (int i = 0; i < runs; ++i) {
    const Bytes data = mutator.mutate(all);
    for (const char* socket : {"command", "control", "reply", "state"}) {
      vectors::Sockets fresh;
      Bytes made, fresh_made, again;
      const bool good = used.again(socket, data, made);
      bool right = good == fresh.again(socket, data, fresh_made) && made == fresh_made;
      if (good)
        right = right && used.again(socket, made, again) && again == made;
      else
        right = right && used.error.path[0] == '$' && used.error.path == fresh.error.path;
      understood += good;
      wrong += !right;
      if (!right) std::printf("%s %s\n", socket, vectors::hex(data).c_str());
    }
  }
  std::printf("%d mutations, %d understood, %d wrong\n", runs, understood, wrong);
  return wrong == 0 ? 0 : 1;
}
