#include "head.h"
#include "pacinian/wire/writer.h"

namespace pacinian::wire {

bool Reader::get(Anything& out) {
  Head head;
  const std::uint8_t* const start = next_;
  if (!take(head)) return false;
  next_ = start;
  switch (head.kind) {
    case Kind::nil:
      out = std::monostate();
      return nil();
    case Kind::boolean:
      return get(alternative<bool>(out));
    case Kind::integer:
      return head.huge ? copy(alternative<Raw>(out).bytes) : get(alternative<std::int64_t>(out));
    case Kind::real:
      return get(alternative<double>(out));
    case Kind::text:
      return get(alternative<std::string>(out));
    default:
      return copy(alternative<Raw>(out).bytes);
  }
}

/// Copies a value with all that it contains, each part in its shortest form.
bool Reader::copy(Bytes& out) {
  Writer writer;
  std::uint64_t left = 1;
  for (Head head; left > 0; --left) {
    std::string_view text;
    const std::uint8_t* const start = next_;
    if (!take(head)) return false;
    left += head.children();
    if (left - 1 > static_cast<std::size_t>(end_ - next_)) return broken("is cut short");
    switch (head.kind) {
      case Kind::boolean:
        writer.put(head.boolean);
        break;
      case Kind::integer:
        head.huge ? writer.put(head.bits) : writer.put(head.integer());
        break;
      case Kind::real:
        writer.put(head.real);
        break;
      case Kind::text:
        next_ = start;
        if (!word(text)) return false;
        writer.text(text);
        break;
      case Kind::bin:
        writer.bin(head.body, head.size);
        break;
      case Kind::array:
        writer.array(head.size);
        break;
      case Kind::map:
        writer.map(head.size);
        break;
      case Kind::extension:
        writer.extension(head.extension, head.body, head.size);
        break;
      default:
        writer.nil();
    }
  }
  out = writer.bytes();
  return true;
}

}  // namespace pacinian::wire
