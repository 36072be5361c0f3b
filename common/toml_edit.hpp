// Edits of values in TOML files: what is not changed stays as written, comments and order included.
#pragma once

#include <string>
#include <vector>

namespace ukemi {

/// The text of a TOML file under edits. A place is the path from the root to a table: keys, and indices of tables in
/// [[ ]], as {"robot", "contact", "2"}. Every edit throws InputError where the file's layout does not allow it (a
/// table of dotted keys). Tests: test/unit/toml_edit.cpp.
class TomlEdit {
 public:
  using Place = std::vector<std::string>;

  /// Throws InputError as TomlFile, but for keys that are not known.
  explicit TomlEdit(const std::string& path);

  bool has(const Place& table, const std::string& key) const;
  /// The text at a key; empty where there is none.
  std::string text_at(const Place& table, const std::string& key) const;
  /// The numbers of a list at a key; empty where there is none.
  std::vector<double> numbers_at(const Place& table, const std::string& key) const;
  /// Sets a number in an existing table; an equal number is left as written.
  void set(const Place& table, const std::string& key, double value);
  /// Sets a text, likewise.
  void set(const Place& table, const std::string& key, const std::string& text);
  /// Sets a value given in TOML syntax.
  void set_raw(const Place& table, const std::string& key, const std::string& value);
  /// Removes a key and its value, if present.
  void remove(const Place& table, const std::string& key);
  /// Removes the top-level table [NAME], if present.
  void remove_table(const std::string& name);
  void append(const std::string& text) { text_ += text; }
  const std::string& text() const { return text_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_, text_;
};

}  // namespace ukemi
