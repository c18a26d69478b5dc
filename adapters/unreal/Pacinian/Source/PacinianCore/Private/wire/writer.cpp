#include "pacinian/wire/writer.h"

#include <msgpack.h>

namespace pacinian::wire {

namespace {

int append(void* bytes, const char* data, std::size_t size) {
  auto& to = *static_cast<Bytes*>(bytes);
  to.insert(to.end(), data, data + size);
  return 0;
}

/// A packer that appends to `bytes`.
msgpack_packer onto(Bytes& bytes) {
  msgpack_packer packer;
  msgpack_packer_init(&packer, &bytes, append);
  return packer;
}

}  // namespace

void Writer::nil() {
  auto packer = onto(bytes_);
  msgpack_pack_nil(&packer);
}

void Writer::map(std::size_t count) {
  auto packer = onto(bytes_);
  msgpack_pack_map(&packer, count);
}

void Writer::array(std::size_t count) {
  auto packer = onto(bytes_);
  msgpack_pack_array(&packer, count);
}

void Writer::text(std::string_view value) {
  auto packer = onto(bytes_);
  msgpack_pack_str_with_body(&packer, value.data(), value.size());
}

void Writer::bin(const std::uint8_t* data, std::size_t size) {
  auto packer = onto(bytes_);
  msgpack_pack_bin(&packer, size);
  bytes_.insert(bytes_.end(), data, data + size);
}

void Writer::extension(std::int8_t type, const std::uint8_t* data, std::size_t size) {
  auto packer = onto(bytes_);
  msgpack_pack_ext(&packer, size, type);
  bytes_.insert(bytes_.end(), data, data + size);
}

void Writer::put(bool value) {
  auto packer = onto(bytes_);
  value ? msgpack_pack_true(&packer) : msgpack_pack_false(&packer);
}

void Writer::put(double value) {
  auto packer = onto(bytes_);
  msgpack_pack_double(&packer, value);
}

void Writer::put(std::int64_t value) {
  auto packer = onto(bytes_);
  msgpack_pack_int64(&packer, value);
}

void Writer::put(std::uint64_t value) {
  auto packer = onto(bytes_);
  msgpack_pack_uint64(&packer, value);
}

void Writer::put(const Raw& value) {
  bytes_.insert(bytes_.end(), value.bytes.begin(), value.bytes.end());
}

}  // namespace pacinian::wire
