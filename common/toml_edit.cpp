#include "common/toml_edit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/csv.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "common/toml.hpp"
#include "common/toml_parser.hpp"

namespace ukemi {

namespace {

/// The table at a place; null where there is none.
const toml::table* table_at(const toml::table& root, const TomlEdit::Place& place) {
  const toml::node* at = &root;
  for (const std::string& step : place) {
    if (const toml::table* t = at->as_table())
      at = t->get(step);
    else if (const toml::array* list = at->as_array())
      at = list->get(parsed_number<std::size_t>(step).value_or(list->size()));
    else
      return nullptr;
    if (!at) return nullptr;
  }
  return at->as_table();
}

/// Byte offset of a parser position, which counts characters.
std::size_t offset(const std::string& text, const toml::source_position& p) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < p.line; ++line) at = text.find('\n', at) + 1;
  for (toml::source_index column = 1; column < p.column; ++column) do
      ++at;
    while (at < text.size() && (text[at] & 0xC0) == 0x80);
  return at;
}

/// Appends the lines of all table headers, [NAME] or [[NAME]].
void header_lines(const toml::table& t, std::vector<toml::source_index>& out) {
  for (const auto& [key, node] : t) {
    if (const toml::table* inner = node.as_table(); inner && !inner->is_inline())
      out.push_back(inner->source().begin.line), header_lines(*inner, out);
    if (const toml::array* list = node.as_array())
      for (const toml::node& item : *list)
        if (const toml::table* inner = item.as_table(); inner && !inner->is_inline())
          out.push_back(inner->source().begin.line), header_lines(*inner, out);
  }
}

}  // namespace

TomlEdit::TomlEdit(const std::string& path) : path_(path) {
  (void)TomlFile(path);  // its checks
  text_ = read_text_file(path);
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
}

bool TomlEdit::has(const Place& table, const std::string& key) const {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, table);
  return t && t->contains(key);
}

std::string TomlEdit::text_at(const Place& table, const std::string& key) const {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, table);
  return t ? (*t)[key].value<std::string>().value_or("") : "";
}

std::vector<double> TomlEdit::numbers_at(const Place& table, const std::string& key) const {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, table);
  std::vector<double> out;
  if (const toml::array* list = t ? (*t)[key].as_array() : nullptr)
    for (const toml::node& item : *list) out.push_back(item.value<double>().value_or(0));
  return out;
}

void TomlEdit::set(const Place& table, const std::string& key, double value) {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, table);
  if (t && (*t)[key].value<double>() == value) return;
  set_raw(table, key, shortest(value));
}

void TomlEdit::set(const Place& table, const std::string& key, const std::string& text) {
  if (!has(table, key) || text_at(table, key) != text) set_raw(table, key, "\"" + toml_text(text) + "\"");
}

void TomlEdit::set_raw(const Place& place, const std::string& key, const std::string& value) {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, place);
  const std::string original = text_;
  if (!t) throw InputError({path_}, fmt::format("'{}': there is no such table to write it in", key));
  if (const toml::node* n = t->get(key)) {
    const std::size_t from = offset(text_, n->source().begin), to = offset(text_, n->source().end);
    text_.replace(from, to - from, value);
  } else if (t->is_inline()) {
    const std::size_t end = text_.rfind('}', offset(text_, t->source().end));
    text_.insert(end, fmt::format("{}{} = {} ", t->empty() ? "" : ", ", key, value));
    if (const std::size_t blank = text_.find_last_not_of(' ', end - 1); !t->empty() && blank + 1 < end)
      text_.erase(blank + 1, end - blank - 1);
  } else {
    const std::size_t line = place.empty() ? 0 : text_.find('\n', offset(text_, t->source().begin)) + 1;
    text_.insert(line, fmt::format("{} = {}\n", key, value));
  }
  // The key must now be found in the intended table.
  const auto fail = [&] {
    text_ = original;
    throw InputError(place_of(path_, t->source()),
                     fmt::format("'{}' cannot be written into this table: give it a header [NAME]", key));
  };
  try {
    const toml::table after = toml::parse(text_);
    const toml::table* in = table_at(after, place);
    if (!in || !in->contains(key)) fail();
  } catch (const toml::parse_error&) {
    fail();
  }
}

void TomlEdit::remove(const Place& place, const std::string& key) {
  const toml::table root = parsed_toml(path_, text_);
  const toml::table* t = table_at(root, place);
  if (!t) return;
  for (const auto& [name, node] : *t) {
    if (name.str() != key) continue;
    std::size_t from = offset(text_, name.source().begin), to = offset(text_, node.source().end);
    if (t->is_inline()) {
      const std::size_t next = text_.find_first_not_of(' ', to), last = text_.find_last_not_of(' ', from - 1);
      if (text_[next] == ',')
        to = text_.find_first_not_of(' ', next + 1);
      else if (text_[last] == ',')
        from = last;
    } else if (const std::size_t end = text_.find_first_not_of(" \t", to); text_[end] == '\n') {
      from = text_.rfind('\n', from) + 1, to = end + 1;
    }
    text_.erase(from, to - from);
    return;
  }
}

void TomlEdit::remove_table(const std::string& name) {
  const toml::table root = parsed_toml(path_, text_);
  const toml::node* n = root.get(name);
  if (!n) return;
  std::vector<toml::source_index> lines;
  header_lines(root, lines);
  const toml::source_index header_line = n->source().begin.line;
  const auto start = [&](toml::source_index line) { return offset(text_, {line, 1}); };
  std::size_t to = text_.size();
  for (const toml::source_index line : lines)
    if (line > header_line) to = std::min(to, start(line));
  text_.erase(start(header_line), to - start(header_line));
}

}  // namespace ukemi
