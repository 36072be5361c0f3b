#include "common/toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "common/toml_parser.hpp"

namespace ukemi {

bool Range::holds(double value) const {
  return std::isfinite(value) && (low_open ? value > low : value >= low) && value <= high;
}

Range Range::any() {
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), false, "a finite number"};
}
Range Range::positive() { return {0, std::numeric_limits<double>::infinity(), true, "above 0"}; }
const Range& Range::link_length() {
  static const Range range{0, 10, true, "above 0 and at most 10: lengths are in m"};
  return range;
}
Range Range::non_negative() { return {0, std::numeric_limits<double>::infinity(), false, "at least 0"}; }

struct TomlFile::Data {
  std::string path;
  toml::table root;
  std::map<std::string, std::set<std::string>> requested;  // section -> keys that were read or accepted
  std::set<std::string> open_sections;                     // sections that accept every key

  Location at(const toml::node& n) const { return place_of(path, n.source()); }
  /// Throws on the first key of a table, or of tables in [[ ]], that was not read; recursive.
  void check(const std::string& name, const toml::node& node) const {
    if (const toml::array* list = node.as_array())
      for (const toml::node& item : *list) check(name, item);
    const auto known = requested.find(name);
    if (!node.is_table() || known == requested.end() || open_sections.count(name)) return;
    for (const auto& [key, value] : *node.as_table()) {
      const std::string k(key.str());
      if (!known->second.count(k))
        throw InputError(place_of(path, key.source()),
                         "unknown key " + quoted(k) + " in [" + name + "]" +
                             hint(k, std::vector<std::string>(known->second.begin(), known->second.end())));
      check(name + "." + k, value);
    }
  }
};

namespace {
const toml::node* as_node(const void* p) { return static_cast<const toml::node*>(p); }
const toml::table& as_table(const void* p) { return *static_cast<const toml::table*>(p); }
/// Writes tables and arrays itself: toml++ 3.3 overflows where it computes the length of a small number.
void write(std::ostream& out, const toml::node& n) {
  const char* between = "";
  if (const toml::array* array = n.as_array()) {
    out << "[ ";
    for (const toml::node& item : *array) out << std::exchange(between, ", "), write(out, item);
    out << " ]";
  } else if (const toml::table* table = n.as_table()) {
    out << "{ ";
    for (const auto& [key, item] : *table) out << std::exchange(between, ", ") << key.str() << " = ", write(out, item);
    out << " }";
  } else {
    n.visit([&](const auto& x) {
      if constexpr (toml::is_value<decltype(x)>) out << x;
    });
  }
}
std::string node_text(const toml::node& n) {
  if (const auto* number = n.as_floating_point()) return quoted(shortest(number->get()));
  std::ostringstream s;
  write(s, n);
  return quoted(s.str());
}

constexpr std::size_t kLargestToml = 16 << 20;

/// toml++ builds and destroys tables recursively: nesting too deep for the stack is refused before parsing.
/// Scans the text by TOML's lexical rules: strings, comments, brackets, the dots between a key's parts.
class NestingCheck {
 public:
  NestingCheck(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (c == '"' || c == '\'') {
        skip_string(c);
      } else {
        if (c == '[' || c == '{') require_depth(++brackets_, "brackets within brackets");
        if ((c == ']' || c == '}') && brackets_ > 0) --brackets_;
        if (c == '.') require_depth(++dots_, "dots in a key");
        if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) dots_ = 0;
        ++at_;
      }
    }
  }

 private:
  static constexpr int kDeepest = 32;

  void require_depth(int depth, const char* of_what) const {
    if (depth <= kDeepest) return;
    const auto before = text_.substr(0, at_);
    const auto line_start = before.rfind('\n') + 1;  // 0 where there is none
    throw InputError({path_, 1 + long(std::count(before.begin(), before.end(), '\n')), 1 + long(at_ - line_start)},
                     fmt::format("more than {} {}", kDeepest, of_what));
  }
  void skip_string(char quote) {
    const std::string triple_quote(3, quote);
    const bool multi_line = text_.substr(at_, 3) == triple_quote;
    const std::string_view end = multi_line ? std::string_view(triple_quote) : text_.substr(at_, 1);
    for (at_ += end.size(); at_ < text_.size() && text_.substr(at_, end.size()) != end; ++at_) {
      if (!multi_line && text_[at_] == '\n') return;  // the parser refuses it
      if (quote == '"' && text_[at_] == '\\') ++at_;
    }
    at_ = std::min(at_ + end.size(), text_.size());
    for (int i = 0; multi_line && i < 2 && text_.substr(at_, 1) == triple_quote.substr(0, 1); ++i)
      ++at_;  // """a"""" ends in a "
  }

  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  int brackets_ = 0, dots_ = 0;
};
}  // namespace

TomlFile::TomlFile(const std::string& path) : TomlFile(path, read_text_file(path, 1 << 20, kLargestToml + 1)) {}
TomlFile::TomlFile(const std::string& path, const std::string& text) : data_(std::make_unique<Data>()) {
  data_->path = path;
  if (text.size() > kLargestToml)
    throw InputError({path}, fmt::format("a TOML file of at most {} bytes is read", kLargestToml));
  NestingCheck(path, text).run();
  data_->root = parsed_toml(path, text);
}
TomlFile::~TomlFile() = default;
TomlFile::TomlFile(TomlFile&&) noexcept = default;
const std::string& TomlFile::path() const { return data_->path; }

std::optional<TomlSection> TomlFile::optional(const std::string& name) {
  data_->requested[name];
  const toml::node* n = data_->root.get(name);
  if (!n) return std::nullopt;
  if (!n->is_table())
    throw InputError(data_->at(*n), "'" + name + "': " + node_text(*n) + ": a table [" + name + "] is needed");
  return TomlSection(data_.get(), n->as_table(), name);
}

std::vector<TomlSection> TomlFile::sections(const std::string& name) {
  const toml::node* n = data_->root.get(name);
  if (!n) return {};
  const auto refuse = [&](const toml::node& wrong) {
    throw InputError(data_->at(wrong), "'" + name + "': " + node_text(wrong) + ": tables [[" + name + "]] are needed");
  };
  if (!n->is_array()) refuse(*n);
  data_->requested[name];
  std::vector<TomlSection> out;
  for (const toml::node& item : *n->as_array()) {
    if (!item.is_table()) refuse(item);
    out.push_back(TomlSection(data_.get(), item.as_table(), name));
  }
  return out;
}

std::optional<std::string> TomlFile::optional_text(const std::string& key) {
  const toml::node* n = data_->root.get(key);
  if (!n || n->is_table()) return std::nullopt;
  data_->requested[key];
  const auto v = n->value<std::string>();
  if (!v) throw InputError(data_->at(*n), "'" + key + "': " + node_text(*n) + ": a text in quotes is needed");
  return v;
}

TomlSection TomlFile::require(const std::string& name) {
  if (auto s = optional(name)) return *s;
  std::vector<std::string> there;
  for (const auto& [k, v] : data_->root) there.emplace_back(k.str());
  const std::string best = nearest(name, there);
  throw InputError({data_->path},
                   "the table [" + name + "] is missing" + (best.empty() ? "" : " (there is [" + best + "])"));
}

void TomlFile::finish() const {
  std::vector<std::string> sections;
  for (const auto& [name, keys] : data_->requested) sections.push_back(name);
  for (const auto& [key, node] : data_->root) {
    const std::string name(key.str());
    const Location where = place_of(data_->path, key.source());
    const auto it = data_->requested.find(name);
    if (it == data_->requested.end()) {
      std::string in;  // a key at top level may belong into a table
      for (const auto& [section, keys] : data_->requested)
        if (keys.count(name)) in = " (it belongs into [" + section + "])";
      throw InputError(where, "unknown " + std::string(node.is_table() ? "table" : "key") + " " + quoted(name) +
                                  (in.empty() ? hint(name, sections) : in));
    }
    data_->check(name, node);
  }
}

TomlSection::TomlSection(TomlFile::Data* data, const void* table, std::string name)
    : data_(data), table_(table), name_(std::move(name)) {}

const void* TomlSection::node(const std::string& key) {
  data_->requested[name_].insert(key);
  return as_table(table_).get(key);
}
std::optional<TomlSection> TomlSection::optional_section(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  if (!as_node(n)->is_table()) fail(key, node_text(*as_node(n)) + ": a table is needed");
  data_->requested[name_ + "." + key];
  return TomlSection(data_, as_node(n)->as_table(), name_ + "." + key);
}
std::vector<TomlSection> TomlSection::sections(const std::string& key) {
  const void* n = node(key);
  std::vector<TomlSection> out;
  if (!n) return out;
  const toml::array* list = as_node(n)->as_array();
  if (!list) fail(key, "tables [[" + name_ + "." + key + "]] are needed");
  data_->requested[name_ + "." + key];
  for (const toml::node& item : *list) {
    if (!item.is_table()) fail(key, node_text(item) + ": a table is needed");
    out.push_back(TomlSection(data_, item.as_table(), name_ + "." + key));
  }
  return out;
}
bool TomlSection::has(const std::string& key) const { return as_table(table_).contains(key); }
void TomlSection::accept_all() { data_->open_sections.insert(name_); }

Location TomlSection::where(const std::string& key) const {
  const toml::node* n = key.empty() ? nullptr : as_table(table_).get(key);
  return data_->at(n ? *n : static_cast<const toml::node&>(as_table(table_)));
}
void TomlSection::fail(const std::string& key, const std::string& message) const {
  throw InputError(where(key), "[" + name_ + "]" + (key.empty() ? "" : " " + key) + ": " + message);
}

double TomlSection::checked(const std::string& key, const void* n, const Range& range) const {
  const auto value = as_node(n)->value<double>();
  if (!value || as_node(n)->is_boolean()) fail(key, node_text(*as_node(n)) + ": a number is needed");
  if (!std::isfinite(*value)) fail(key, shortest(*value) + ": a finite number is needed");
  if (const auto* whole = as_node(n)->as_integer(); whole && whole->flags() != toml::value_flags::none)
    fail(key, node_text(*as_node(n)) + ": a decimal number is needed");
  if (!range.holds(*value)) fail(key, shortest(*value) + ": must be " + range.rule);
  return *value;
}

std::optional<double> TomlSection::optional_number(const std::string& key, const Range& range) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  return checked(key, n, range);
}
double TomlSection::number(const std::string& key, const Range& range) {
  if (const auto v = optional_number(key, range)) return *v;
  std::vector<std::string> there;  // keys of the table that were not requested
  for (const auto& [k, v] : as_table(table_))
    if (!data_->requested[name_].contains(std::string(k.str()))) there.emplace_back(k.str());
  const std::string best = nearest(key, there);
  throw InputError(
      where(), "[" + name_ + "] the key '" + key + "' is missing" + (best.empty() ? "" : " (there is '" + best + "')"));
}

namespace {

/// How an angle or its rate is given: under `key` in radians, or under `key_deg`. Both keys become known.
struct AngleKey {
  AngleKey(TomlSection& s, const std::string& key) : section(s), name(key) {
    const std::string in_degrees = key + "_deg";
    s.accept(key), s.accept(in_degrees);
    if (!s.has(in_degrees)) return;
    if (s.has(key)) s.fail(in_degrees, "given beside '" + key + "': one of the two is needed");
    name = in_degrees, unit = kDegree;
  }
  /// A value as an angle [rad].
  double angle(double value) const {
    if (unit == 1 && std::abs(value) > 2 * std::numbers::pi)
      section.fail(name,
                   shortest(value) + ": an angle in radians beyond 2 pi; for degrees name the key '" + name + "_deg'");
    return value * unit;
  }
  TomlSection& section;
  std::string name;
  double unit = 1;  ///< [rad] or [rad/s]
};

}  // namespace

std::optional<double> TomlSection::optional_angle(const std::string& key) {
  const AngleKey given(*this, key);
  const auto v = optional_number(given.name, Range::any());
  return v ? std::optional(given.angle(*v)) : v;
}
double TomlSection::angle(const std::string& key) {
  const auto v = optional_angle(key);
  return v ? *v : number(key + "_deg", Range::any());  // throws: the key is missing
}
std::optional<double> TomlSection::optional_rate(const std::string& key) {
  const AngleKey given(*this, key);
  const auto v = optional_number(given.name, Range::any());
  return v ? std::optional(*v * given.unit) : v;
}
std::optional<std::array<double, 2>> TomlSection::optional_angle_pair(const std::string& key) {
  const AngleKey given(*this, key);
  const auto v = optional_numbers(given.name, 2, Range::any());
  if (!v) return std::nullopt;
  return std::array{given.angle((*v)[0]), given.angle((*v)[1])};
}

std::optional<std::vector<double>> TomlSection::optional_numbers(const std::string& key, std::size_t count,
                                                                 const Range& range) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  const toml::array* array = as_node(n)->as_array();
  if (!array || array->size() != count)
    fail(key, node_text(*as_node(n)) + ": " + std::to_string(count) + " numbers in [ ] are needed");
  std::vector<double> out;
  for (const toml::node& x : *array) out.push_back(checked(key, &x, range));
  return out;
}
std::vector<double> TomlSection::optional_list(const std::string& key, std::size_t max_size, const Range& range) {
  const void* n = node(key);
  if (!n) return {};
  const toml::array* array = as_node(n)->as_array();
  if (!array || array->size() > max_size)
    fail(key, node_text(*as_node(n)) + ": at most " + std::to_string(max_size) + " numbers in [ ] are needed");
  return *optional_numbers(key, array->size(), range);
}
std::optional<long> TomlSection::optional_count(const std::string& key, long lowest, long highest) {
  const auto v = optional_number(key, Range::any());
  if (!v) return std::nullopt;
  if (*v != std::floor(*v) || *v < double(lowest) || *v > double(highest))
    fail(key, shortest(*v) + ": a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest) +
                  " is needed");
  return long(*v);
}
std::vector<double> TomlSection::numbers(const std::string& key, std::size_t count, const Range& range) {
  if (auto v = optional_numbers(key, count, range)) return *v;
  throw InputError(
      where(), "[" + name_ + "] the key '" + key + "' is missing: " + std::to_string(count) + " numbers are needed");
}

std::optional<std::vector<std::vector<double>>> TomlSection::optional_matrix(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  const toml::array* rows = as_node(n)->as_array();
  if (!rows) fail(key, "rows of numbers in [ ] are needed");
  std::vector<std::vector<double>> out;
  for (const toml::node& r : *rows) {
    const toml::array* row = r.as_array();
    if (!row || row->size() != rows->size()) fail(key, "a square matrix is needed");
    out.emplace_back();
    for (const toml::node& x : *row) out.back().push_back(checked(key, &x, Range::any()));
  }
  return out;
}

std::optional<double> TomlSection::optional_part(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  const auto text = as_node(n)->value<std::string>();
  if (!text) return checked(key, n, Range::non_negative());
  const auto percent = text->ends_with('%') ? parsed_number<double>(text->substr(0, text->size() - 1)) : std::nullopt;
  if (!percent || !Range::non_negative().holds(*percent))
    fail(key, quoted(*text) + ": a number of at least 0, or a percentage such as \"1%\", is needed");
  return *percent / 100;
}
std::optional<bool> TomlSection::optional_flag(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  if (!as_node(n)->is_boolean()) fail(key, node_text(*as_node(n)) + ": true or false is needed");
  return *as_node(n)->value<bool>();
}
std::optional<std::string> TomlSection::optional_text(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  const auto v = as_node(n)->value<std::string>();
  if (!v) fail(key, node_text(*as_node(n)) + ": a text in quotes is needed");
  return *v;
}
std::string TomlSection::text(const std::string& key) {
  if (auto v = optional_text(key)) return *v;
  throw InputError(where(), "[" + name_ + "] the key '" + key + "' is missing");
}
std::optional<std::vector<std::string>> TomlSection::optional_texts(const std::string& key) {
  const void* n = node(key);
  if (!n) return std::nullopt;
  const toml::array* array = as_node(n)->as_array();
  if (!array) fail(key, node_text(*as_node(n)) + ": texts in [ ] are needed");
  std::vector<std::string> out;
  for (const toml::node& x : *array) {
    if (!x.is_string()) fail(key, node_text(x) + ": a text in quotes is needed");
    out.push_back(*x.value<std::string>());
  }
  return out;
}
std::optional<std::string> TomlSection::optional_choice(const std::string& key,
                                                        const std::vector<std::string>& choices) {
  auto v = optional_text(key);
  if (!v) return std::nullopt;
  std::string list;
  for (const std::string& c : choices) {
    if (c == *v) return v;
    list += (list.empty() ? "\"" : ", \"") + c + "\"";
  }
  fail(key, ukemi::quoted(*v) + ": one of " + list + " is needed");
}

std::string toml_text(const std::string& s) {
  std::string out;
  for (std::string_view remaining = s; !remaining.empty();) {
    const Character c = first_character(remaining);
    if (c.bytes == "\"" || c.bytes == "\\")
      out += '\\' + std::string(c.bytes);
    else if (c.printable())
      out += c.bytes;
    else
      out += c.code < 0 ? '\\' + shown(c.bytes) : fmt::format("\\u{:04X}", c.code);
    remaining.remove_prefix(c.bytes.size());
  }
  return out;
}

}  // namespace ukemi
