// Declarative tables of results: each quantity has its names in files, its heading and format, and a getter. JSON, CSV,
// terminal output and report tables are made from these.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "tools/program/output.hpp"

namespace ukemi::tools {

/// How a value is shown: a format of fmt, or a function of a number. An unknown value is shown as ""; a function gets
/// NaN.
class Format {
 public:
  Format(const char* format = "{}") : format_(format) {}
  Format(std::string (*words)(double)) : words_(words) {}
  std::string operator()(const Json& value) const;

 private:
  const char* format_ = nullptr;
  std::string (*words_)(double) = nullptr;
};

/// "740 ± 200": the error to two significant digits, the value to the error's last digit.
std::string with_error(double value, double error);

/// Names of a quantity; an empty one: it is left out there.
struct Names {
  std::string csv;    ///< column
  std::string json;   ///< key, or path as in "hold/peak_acceleration"
  std::string words;  ///< heading with the unit: "duration [s]"
  Format format;
};
/// A quantity of a result or of a row.
template <class T>
struct Quantity : Names {
  using Value = std::function<Json(const T&)>;
  Value value;

  Quantity(std::string column, std::string key, std::string heading, Format shown_as, Value getter)
      : Names{std::move(column), std::move(key), std::move(heading), shown_as}, value(std::move(getter)) {}
  /// For files only, under two names or one.
  Quantity(std::string column, std::string key, Value getter) : Quantity(column, key, "", {}, getter) {}
  Quantity(std::string name, Value getter) : Quantity(name, name, getter) {}
};
template <class T>
using Quantities = std::vector<Quantity<T>>;

/// Appends quantities of a part as quantities of the whole; in JSON under `path`: "motion/".
template <class T, class U, class Part>
void append(Quantities<T>& to, const std::string& path, const Quantities<U>& quantities, Part part) {
  for (const Quantity<U>& q : quantities)
    to.push_back({q.csv, q.json.empty() ? "" : path + q.json, q.words, q.format,
                  [value = q.value, part](const T& whole) { return value(std::invoke(part, whole)); }});
}
/// Appends quantities of an optional part; null where has(whole) is false.
template <class T, class U, class Part, class Has>
void append(Quantities<T>& to, const std::string& path, const Quantities<U>& quantities, Part part, Has has) {
  const std::size_t before = to.size();
  append(to, path, quantities, part);
  for (std::size_t i = before; i < to.size(); ++i)
    to[i].value = [value = to[i].value, has](const T& whole) {
      return std::invoke(has, whole) ? value(whole) : Json();
    };
}

/// Rows of quantities; a single result is one row.
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

  Json objects() const;                    ///< an array with an object per row
  Json object(std::size_t row = 0) const;  ///< one row
  Json keyed() const;                      ///< an object with a key per row: its first quantity
  std::string csv(const Run& run, const std::string& comment = "") const;
  std::vector<std::string> headings() const;            ///< of the shown columns; empty columns are left out
  std::vector<std::vector<std::string>> shown() const;  ///< cells of the shown columns
  std::vector<std::string> lines() const;               ///< headings and rows, aligned
  std::string line(std::size_t row = 0) const;          ///< one row: "words value; ..."
  Table transposed() const;                             ///< the first row as two columns: headings, values

 private:
  Table() = default;
  std::vector<std::size_t> columns() const;  ///< the shown ones
  std::vector<Names> names_;
  std::vector<std::vector<Json>> rows_;
};

/// Prints its lines.
void say(const Table& table, const Run& run);

}  // namespace ukemi::tools
