#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pacinian::wire {

/// Reads tokens of JSON (RFC 8259) one by one. The methods return false if another token comes next.
class JsonScanner {
 public:
  explicit JsonScanner(std::string_view text) : text_(text) {}

  bool at(char mark);
  bool take(char mark);
  bool string(std::string& out);
  bool skip(int depth, std::string_view& token);  ///< any value; `token`: its text
  bool done();
  std::size_t position() const { return next_; }

 private:
  void blank();
  bool escape(std::string& out);
  bool hex(unsigned& out);
  bool number();
  std::size_t digits();
  bool members(int depth, char close, bool named);

  std::string_view text_;
  std::size_t next_ = 0;
};

}  // namespace pacinian::wire
