// Reading TOML files: every key is read with its rule; a key that is not read is an error that names the nearest known
// key.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"

namespace ukemi {

/// The values a number may take.
struct Range {
  double low, high;
  bool low_open = false;
  std::string rule;  ///< the rule in words, for the message

  /// Whether it is finite and within both ends.
  bool holds(double value) const;

  static Range any();
  static Range positive();
  static Range non_negative();
  static const Range& link_length();  ///< in m: above 0 and at most 10; what is longer was meant in mm
};

class TomlSection;

/// One TOML file. Ask it for its sections, then call `finish`.
class TomlFile {
 public:
  /// Throws InputError with line and column on what is no TOML, nests deeper than 32, or is longer than 16 MiB.
  explicit TomlFile(const std::string& path);
  /// Parses `text` as the content of `path`.
  TomlFile(const std::string& path, const std::string& text);
  ~TomlFile();
  TomlFile(TomlFile&&) noexcept;

  /// A table. A missing one that is `required` throws; an optional one gives an empty optional.
  TomlSection require(const std::string& name);
  std::optional<TomlSection> optional(const std::string& name);
  /// Tables [[NAME]], in their order; none where there are none.
  std::vector<TomlSection> sections(const std::string& name);
  /// A text of the top level; none where the key is omitted or names a table.
  std::optional<std::string> optional_text(const std::string& key);
  /// Throws on the first table or key that was not read.
  void finish() const;
  const std::string& path() const;

 private:
  friend class TomlSection;
  struct Data;
  std::unique_ptr<Data> data_;
};

/// One table of a file. Each getter throws InputError with file:line:column on a wrong type or a value outside its
/// rule.
class TomlSection {
 public:
  double number(const std::string& key, const Range& range);
  std::optional<double> optional_number(const std::string& key, const Range& range);
  /// `key` [rad] or `key_deg`; an angle in radians beyond 2 pi is refused with a hint.
  double angle(const std::string& key);
  std::optional<double> optional_angle(const std::string& key);
  /// Rate of `key` [rad/s] or `key_deg` [deg/s].
  std::optional<double> optional_rate(const std::string& key);
  std::optional<std::array<double, 2>> optional_angle_pair(const std::string& key);
  std::vector<double> numbers(const std::string& key, std::size_t count, const Range& range);
  std::optional<std::vector<double>> optional_numbers(const std::string& key, std::size_t count, const Range& range);
  /// A list of at most `max_size` numbers; a missing one is empty.
  std::vector<double> optional_list(const std::string& key, std::size_t max_size, const Range& range);
  std::optional<long> optional_count(const std::string& key, long lowest, long highest);
  std::optional<std::vector<std::vector<double>>> optional_matrix(const std::string& key);
  std::string text(const std::string& key);
  /// A number, or a percentage in quotes ("1%"), at least 0.
  std::optional<double> optional_part(const std::string& key);
  std::optional<bool> optional_flag(const std::string& key);
  std::optional<std::string> optional_text(const std::string& key);
  std::optional<std::vector<std::string>> optional_texts(const std::string& key);
  /// One of `choices`.
  std::optional<std::string> optional_choice(const std::string& key, const std::vector<std::string>& choices);
  /// A table within this one; none where the key is omitted.
  std::optional<TomlSection> optional_section(const std::string& key);
  /// Tables in [[ ]], in their order; empty where the key is omitted.
  std::vector<TomlSection> sections(const std::string& key);
  /// Marks a key as known without reading it.
  void accept(const std::string& key) { node(key); }
  /// Accepts whatever else the table holds (provenance).
  void accept_all();
  bool has(const std::string& key) const;
  /// The place of a key, or of the table if it has no such key.
  Location where(const std::string& key = "") const;
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  friend class TomlFile;
  TomlSection(TomlFile::Data* data, const void* table, std::string name);
  const void* node(const std::string& key);
  double checked(const std::string& key, const void* node, const Range& range) const;

  TomlFile::Data* data_;
  const void* table_;
  std::string name_;
};

/// `s` escaped for a quoted TOML string. It reads back unchanged, except for bytes that are no UTF-8, which TOML cannot
/// hold: they are written as \xNN, as `shown` does.
std::string toml_text(const std::string& s);

}  // namespace ukemi
