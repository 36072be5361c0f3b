// Bounds-checked reader of protobuf's wire format: iterates over the fields of one message.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/error.hpp"

namespace ukemi::identify {

/// Bytes of a file, with their offset in it. Every read is checked; errors name the byte.
struct Bytes {
  std::string_view data;
  std::size_t offset = 0;             ///< of data[0] in the file
  const std::string* file = nullptr;  ///< its name, for errors

  std::size_t size() const { return data.size(); }
  [[noreturn]] void fail(std::size_t at, const std::string& message) const {
    throw InputError(*file + ": byte " + std::to_string(offset + at) + ": " + message);
  }
  /// `count` bytes from `at`.
  Bytes part(std::size_t at, std::size_t count, const char* what) const {
    if (at > data.size() || count > data.size() - at) fail(at, std::string(what) + ": runs over its end");
    return {data.substr(at, count), offset + at, file};
  }
  template <class Unsigned>
  Unsigned big_endian(std::size_t at) const {
    Unsigned value = 0;
    for (const char c : part(at, sizeof(Unsigned), "a number").data)
      value = Unsigned(value << 8) | Unsigned(static_cast<unsigned char>(c));
    return value;
  }
};

/// One field: a number for varint, fixed32 and fixed64, bytes for the length-delimited.
struct ProtobufField {
  enum class Type { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
  std::uint32_t number = 0;
  Type type = Type::kVarint;
  std::uint64_t value = 0;
  Bytes bytes;         ///< kBytes: the content
  std::size_t at = 0;  ///< offset of the field in its message
};

/// Walks the fields of a message. Throws InputError on a field that runs over the end, a varint of more than 10 bytes,
/// field number 0 and wire types other than the four above.
class ProtobufReader {
 public:
  explicit ProtobufReader(const Bytes& message) : message_(message) {}

  bool next(ProtobufField& field) {
    if (at_ == message_.size()) return false;
    field.at = at_;
    const std::uint64_t key = varint();
    field.number = std::uint32_t(key >> 3);
    if (key >> 3 == 0 || key >> 3 >= (1u << 29)) message_.fail(field.at, "a protobuf field number that cannot be");
    field.type = ProtobufField::Type(key & 7);
    switch (field.type) {
      case ProtobufField::Type::kVarint:
        field.value = varint();
        break;
      case ProtobufField::Type::kFixed64:
      case ProtobufField::Type::kFixed32:
        field.value = little_endian(field.type == ProtobufField::Type::kFixed64 ? 8 : 4);
        break;
      case ProtobufField::Type::kBytes: {
        const std::uint64_t length = varint();
        if (length > message_.size() - at_) message_.fail(field.at, "a protobuf field runs over its message's end");
        field.bytes = message_.part(at_, std::size_t(length), "a protobuf field");
        at_ += std::size_t(length);
        break;
      }
      default:
        message_.fail(field.at, "protobuf wire type " + std::to_string(key & 7) + ": 0, 1, 2 or 5 is needed");
    }
    return true;
  }

 private:
  std::uint64_t varint() {
    std::uint64_t value = 0;
    const std::size_t start = at_;
    for (int shift = 0; shift < 70; shift += 7) {
      if (at_ == message_.size()) message_.fail(start, "a protobuf varint runs over its message's end");
      const auto byte = static_cast<unsigned char>(message_.data[at_++]);
      value |= std::uint64_t(byte & 127) << shift;
      if (byte < 128) return value;
    }
    message_.fail(start, "a protobuf varint of more than 10 bytes");
  }
  std::uint64_t little_endian(std::size_t count) {
    const Bytes part = message_.part(at_, count, "a protobuf number");
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(part.data[i]);
    at_ += count;
    return value;
  }

  Bytes message_;
  std::size_t at_ = 0;
};

/// A signed number from its zigzag form (protobuf's sint64).
inline std::int64_t zigzag(std::uint64_t n) { return std::int64_t(n >> 1) ^ -std::int64_t(n & 1); }

}  // namespace ukemi::identify
