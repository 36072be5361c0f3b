// TOML files with other values: what is not changed stays as it is, comments and order included.
#pragma once

#include <string>
#include <vector>

namespace ukemi {

/// The text of a TOML file under edits. A place is the way from the top to a table: keys, and indices of tables in
/// [[ ]], as {"robot", "contact", "2"}. Every edit throws InputError where the file is written in a way that it cannot
/// follow (a table of dotted keys). Tests: test/unit/toml_edit.cpp.
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
  /// A number at a key of a table that is there; a number that is there already is left as it is written.
  void set(const Place& table, const std::string& key, double value);
  /// A text likewise.
  void set(const Place& table, const std::string& key, const std::string& text);
  /// Anything else, as TOML writes it.
  void set_raw(const Place& table, const std::string& key, const std::string& value);
  /// A key and its value, where they are there.
  void remove(const Place& table, const std::string& key);
  /// A table of the top level, [NAME], where it is there.
  void remove_table(const std::string& name);
  void append(const std::string& text) { text_ += text; }
  const std::string& text() const { return text_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_, text_;
};

}  // namespace ukemi
