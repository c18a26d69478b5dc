// SHA-256 and HMAC are those of the standards: examples of FIPS 180-4 and of RFC 4231.
#include "client/sha256.h"
#include "expect.h"

namespace {

std::string hex(const pacinian::client::Digest& digest) {
  std::string made;
  for (const std::uint8_t byte : digest) made += {"0123456789abcdef"[byte >> 4], "0123456789abcdef"[byte & 15]};
  return made;
}

std::vector<std::uint8_t> bytes(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

int main() {
  using namespace pacinian::client;
  EXPECT(hex(sha256({})) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT(hex(sha256(bytes("abc"))) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT(hex(sha256(bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"))) ==
         "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT(hex(hmac_sha256("Jefe", bytes("what do ya want for nothing?"))) ==
         "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT(hex(hmac_sha256(std::string(131, '\xaa'), bytes("Test Using Larger Than Block-Size Key - Hash Key First"))) ==
         "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
  return check::result();
}
