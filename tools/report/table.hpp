// A result, described once: each quantity has its names in files, its words, unit and format for a reader, and how
// it is taken from the result. JSON, CSV, the lines on the terminal and the tables of a report are made from that.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "tools/program/output.hpp"

namespace ukemi::tools {

/// How a value is shown to a reader: a format of fmt, or words for a number. What is not known is shown as "", by
/// words as they like: they are given NaN.
class Format {
 public:
  Format(const char* format = "{}") : format_(format) {}
  Format(std::string (*words)(double)) : words_(words) {}
  std::string operator()(const Json& value) const;

 private:
  const char* format_ = nullptr;
  std::string (*words_)(double) = nullptr;
};

/// "740 ± 200": the error to two digits, the value to the error's last one.
std::string with_error(double value, double error);

/// What a quantity is called. An empty name: it is not written there.
struct Names {
  std::string csv;    ///< column
  std::string json;   ///< key, or path as in "hold/peak_acceleration"
  std::string words;  ///< for a reader, with the unit: "duration [s]"
  Format format;
};
/// A quantity of a result or of a row.
template <class T>
struct Quantity : Names {
  using Value = std::function<Json(const T&)>;
  Value value;

  Quantity(std::string column, std::string key, std::string heading, Format how, Value of)
      : Names{std::move(column), std::move(key), std::move(heading), how}, value(std::move(of)) {}
  /// For files alone, under two names or one.
  Quantity(std::string column, std::string key, Value of) : Quantity(column, key, "", {}, of) {}
  Quantity(std::string name, Value of) : Quantity(name, name, of) {}
};
template <class T>
using Quantities = std::vector<Quantity<T>>;

/// The quantities of a part, as those of the whole; in JSON under `path`, as "motion/".
template <class T, class U, class Part>
void append(Quantities<T>& to, const std::string& path, const Quantities<U>& quantities, Part part) {
  for (const Quantity<U>& q : quantities)
    to.push_back({q.csv, q.json.empty() ? "" : path + q.json, q.words, q.format,
                  [value = q.value, part](const T& whole) { return value(std::invoke(part, whole)); }});
}
/// Of a part that some wholes lack: not known there.
template <class T, class U, class Part, class Has>
void append(Quantities<T>& to, const std::string& path, const Quantities<U>& quantities, Part part, Has has) {
  const std::size_t before = to.size();
  append(to, path, quantities, part);
  for (std::size_t i = before; i < to.size(); ++i)
    to[i].value = [value = to[i].value, has](const T& whole) {
      return std::invoke(has, whole) ? value(whole) : Json();
    };
}

/// Rows of such quantities; a result by itself is one row.
class Table {
 public:
  template <class T>
  Table(const Quantities<T>& quantities, const std::vector<std::type_identity_t<T>>& rows)
      : names_(quantities.begin(), quantities.end()) {
    for (const T& row : rows) {
      rows_.emplace_back();
      for (const Quantity<T>& q : quantities) rows_.back().push_back(q.value(row));
    }
  }
  template <class T>
  static Table of(const Quantities<T>& quantities, const T& result) {
    return Table(quantities, std::vector<T>{result});
  }

  Json objects() const;                    ///< an array, an object a row
  Json object(std::size_t row = 0) const;  ///< one row
  Json keyed() const;                      ///< an object, a key a row: the text of its first quantity
  std::string csv(const Run& run, const std::string& comment = "") const;
  std::vector<std::string> headings() const;            ///< of what a reader sees: what no row has is left out
  std::vector<std::vector<std::string>> shown() const;  ///< as `headings`
  std::vector<std::string> lines() const;               ///< headings and rows, aligned
  std::string line(std::size_t row = 0) const;          ///< one row: "words value; ..."
  Table turned() const;                                 ///< the first row as a column of values beside their headings

 private:
  Table() = default;
  std::vector<std::size_t> columns() const;  ///< that are shown
  std::vector<Names> names_;
  std::vector<std::vector<Json>> rows_;
};

/// Its lines on the terminal.
void say(const Table& table, const Run& run);

}  // namespace ukemi::tools
