#include "identify/logs/hebilog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/files.hpp"
#include "common/text.hpp"
#include "identify/logs/protobuf.hpp"

namespace ukemi::identify {

namespace {

// Layout: big-endian; a magic number starts the header and every record. Payloads are protobuf, little-endian.
constexpr std::uint16_t kMagic = 0x73B1;
enum Record : std::uint16_t { kHeader = 2, kFeedback = 1, kUnknown = 4, kFeedbackAndInfo = 5 };
constexpr std::size_t kUnknownSize = 12, kRecordHeader = 26, kAddress = 8;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string address_of(const Bytes& b, std::size_t at) {
  const Bytes a = b.part(at, 4, "an address");
  const auto byte = [&](std::size_t i) { return int(static_cast<unsigned char>(a.data[i])); };
  return fmt::format("{}.{}.{}.{}", byte(0), byte(1), byte(2), byte(3));
}

/// Calls visit(field) for each field of a message.
template <class Visit>
void for_fields(const Bytes& message, Visit&& visit) {
  ProtobufReader reader(message);
  for (ProtobufField f; reader.next(f);) visit(f);
}

/// A submessage; InputError where the field is of another wire type.
const Bytes& submessage(const Bytes& in, const ProtobufField& f) {
  if (f.type != ProtobufField::Type::kBytes) in.fail(f.at, fmt::format("field {}: a submessage is needed", f.number));
  return f.bytes;
}
double float_of(const Bytes& in, const ProtobufField& f) {
  if (f.type != ProtobufField::Type::kFixed32)
    in.fail(f.at, fmt::format("field {}: a 32-bit float is needed", f.number));
  return double(std::bit_cast<float>(std::uint32_t(f.value)));
}

/// {1: revolutions (zigzag), 2: offset [rad]}: an angle of many turns [rad].
double multi_turn_angle(const Bytes& message) {
  double revolutions = 0, offset = kNone;
  for_fields(message, [&](const ProtobufField& f) {
    if (f.number == 1 && f.type == ProtobufField::Type::kVarint) revolutions = double(zigzag(f.value));
    if (f.number == 2) offset = float_of(message, f);
  });
  return 2 * std::numbers::pi * revolutions + offset;
}

/// Reads field n, a float, into targets[n - 1], if there is one; n counts from 1.
template <class Number>
void set_float(const Bytes& in, const ProtobufField& f, std::initializer_list<Number*> targets) {
  if (f.number <= targets.size()) *targets.begin()[f.number - 1] = float_of(in, f);
}

HebiGains read_gains(const Bytes& message) {
  HebiGains g;
  for_fields(message, [&](const ProtobufField& f) { set_float(message, f, {&g.k_p, &g.k_i, &g.k_d}); });
  return g;
}

/// Field 20: names, controller, spring.
void read_info(const Bytes& message, HebiModule& m) {
  for_fields(message, [&](const ProtobufField& f) {
    if (f.number == 1)
      for_fields(submessage(message, f), [&](const ProtobufField& n) {
        if (n.number == 1) m.name = submessage(f.bytes, n).data;
        if (n.number == 2) m.family = submessage(f.bytes, n).data;
      });
    if (f.number == 3)
      for_fields(submessage(message, f), [&](const ProtobufField& c) {
        if (c.number == 3) m.position_gains = read_gains(submessage(f.bytes, c));
        if (c.number == 4) m.velocity_gains = read_gains(submessage(f.bytes, c));
        if (c.number == 5) m.effort_gains = read_gains(submessage(f.bytes, c));
        if (c.number == 6) m.spring_constant = float_of(f.bytes, c);
      });
  });
}

/// Calls visit(message, field) for each field of submessage 9 of a field.
template <class Visit>
void for_fields_of_part_nine(const Bytes& in, const ProtobufField& f, Visit&& visit) {
  for_fields(submessage(in, f), [&](const ProtobufField& n) {
    if (n.number != 9) return;
    const Bytes& nine = submessage(f.bytes, n);
    for_fields(nine, [&](const ProtobufField& field) { visit(nine, field); });
  });
}

void read_payload(const Bytes& payload, double t, HebiModule& m) {
  m.t.push_back(t);
  for (auto* column : {&m.position, &m.velocity, &m.effort, &m.deflection, &m.motor_velocity, &m.motor_position,
                       &m.position_command, &m.velocity_command, &m.effort_command})
    column->push_back(kNone);
  double fine_position = kNone;
  for_fields(payload, [&](const ProtobufField& f) {
    if (f.number == 10)  // 10.9: commands
      for_fields_of_part_nine(payload, f, [&](const Bytes& in, const ProtobufField& n) {
        set_float(in, n, {&m.position_command.back(), &m.velocity_command.back(), &m.effort_command.back()});
      });
    if (f.number == 11)  // 11.9: measurements
      for_fields_of_part_nine(payload, f, [&](const Bytes& in, const ProtobufField& n) {
        set_float(
            in, n,
            {&m.position.back(), &m.velocity.back(), &m.effort.back(), &m.deflection.back(), &m.motor_velocity.back()});
        if (n.number == 12) fine_position = multi_turn_angle(submessage(in, n));
        if (n.number == 13) m.motor_position.back() = multi_turn_angle(submessage(in, n));
      });
    if (f.number == 20) read_info(submessage(payload, f), m);
  });
  if (std::isnan(m.position.back())) m.position.back() = fine_position;
}

void check_magic(const Bytes& all, std::size_t at) {
  const auto magic = all.big_endian<std::uint16_t>(at);
  if (magic != kMagic)
    all.fail(at, fmt::format("0x{:04x}: a record of a .hebilog starts with 0x{:04x}", magic, kMagic));
}

/// The modules that the header lists.
std::vector<HebiModule> read_header(const Bytes& all) {
  if (all.size() == 0) all.fail(0, "the file is empty: the header of a .hebilog is needed");
  if (all.size() < 8) all.fail(all.size(), "the file ends inside its header");
  check_magic(all, 0);
  if (const auto type = all.big_endian<std::uint16_t>(2); type != kHeader)
    all.fail(2, fmt::format("record type {}: a .hebilog starts with its header, type {}", type, int(kHeader)));
  const auto count = all.big_endian<std::uint32_t>(4);
  if (count == 0) all.fail(4, "0 modules: at least one is needed");
  if (count > (all.size() - 8) / kAddress)
    all.fail(4, fmt::format("{} modules: the file has room for {}", count, (all.size() - 8) / kAddress));
  std::vector<HebiModule> modules;
  for (std::size_t i = 0; i < count; ++i) {
    HebiModule m;
    m.port = all.big_endian<std::uint32_t>(8 + kAddress * i);
    m.address = address_of(all, 12 + kAddress * i);
    modules.push_back(m);
  }
  return modules;
}

}  // namespace

bool is_hebilog(const std::string& path) {
  if (lower_case(path).ends_with(".hebilog")) return true;
  const std::string text = read_binary_file(path, 2);
  return text.size() == 2 && text[0] == char(kMagic >> 8) && text[1] == char(kMagic & 0xFF);
}

HebiLog read_hebilog(const std::string& path) {
  const std::string text = read_binary_file(path);
  HebiLog log;
  log.file = path;
  const Bytes all{text, 0, &path};
  log.modules = read_header(all);

  bool stamped = false;
  std::uint64_t first = 0;
  std::size_t samples = 0, at = 8 + kAddress * log.modules.size();
  while (at < text.size()) {
    const std::size_t left = text.size() - at;
    if (left >= 2) check_magic(all, at);
    std::size_t size = 4;
    std::uint16_t type = 0;
    if (left >= 4) {
      type = all.big_endian<std::uint16_t>(at + 2);
      if (type != kFeedback && type != kFeedbackAndInfo && type != kUnknown)
        all.fail(at + 2, fmt::format("record type {}: 1, 4 or 5 is needed", type));
      size = type == kUnknown ? kUnknownSize : kRecordHeader;
    }
    if (type != kUnknown && left >= kRecordHeader) {
      const auto length = all.big_endian<std::uint32_t>(at + 12);
      const auto payload = all.big_endian<std::uint16_t>(at + 24);
      if (length != payload + 2u)
        all.fail(at + 12, fmt::format("length {} beside a payload of {} bytes: it must be 2 more", length, payload));
      size += payload;
    }
    if (size > left) {
      log.notes.push_back(fmt::format("the file ends inside its last record (byte {}): {} bytes left out", at, left));
      break;
    }
    if (type != kUnknown) {
      const auto port = all.big_endian<std::uint32_t>(at + 4);
      const std::string address = address_of(all, at + 8);
      const auto m = std::find_if(log.modules.begin(), log.modules.end(),
                                  [&](const HebiModule& k) { return k.port == port && k.address == address; });
      if (m == log.modules.end())
        all.fail(at + 4, fmt::format("module {}:{}: the file's header does not list it", address, port));
      const auto stamp = all.big_endian<std::uint64_t>(at + 16);
      if (!stamped) first = stamp, stamped = true;
      const double t = 1e-6 * double(std::int64_t(stamp - first));
      read_payload(all.part(at + kRecordHeader, size - kRecordHeader, "a payload"), t, *m);
      ++samples;
    }
    at += size;
  }
  if (samples == 0) all.fail(at, "the file ends before its first whole feedback record");
  return log;
}

}  // namespace ukemi::identify
