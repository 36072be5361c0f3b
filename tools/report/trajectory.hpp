// The rows of a landing as files.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// A column of both files, of rows that have a time `t`.
template <class Row>
struct RowColumn {
  std::string name;      ///< in trajectory.csv
  std::string in_words;  ///< for PlotJuggler: a place in its tree, and the unit
  std::function<double(const Row&)> value;
};
template <class Row>
using RowColumns = std::vector<RowColumn<Row>>;

/// Header and rows behind what `csv` holds.
template <class Row>
std::string rows_csv(CsvWriter csv, const RowColumns<Row>& columns, std::string RowColumn<Row>::*name,
                     const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const RowColumn<Row>& c : columns) names.push_back(c.*name);
  csv.header(names);
  for (const Row& row : rows) {
    for (const RowColumn<Row>& c : columns) csv.cell(c.value(row));
    csv.end_row();
  }
  return csv.text();
}

/// The rows for PlotJuggler, which takes no `#` lines and one row a time: names with units and '/', without blanks; the
/// second row of an event comes the smallest step of a number later.
template <class Row>
std::string plotjuggler_csv(const RowColumns<Row>& columns, std::vector<Row> rows) {
  double before = -std::numeric_limits<double>::infinity();
  for (Row& r : rows) {
    if (r.t <= before) r.t = std::nextafter(before, std::numeric_limits<double>::infinity());
    before = r.t;
  }
  return rows_csv({}, columns, &RowColumn<Row>::in_words, rows);
}

/// trajectory.csv of the paper's robot, and its columns.
std::string trajectory_csv(const std::vector<landing::Sample>& trajectory, const Run& run);
const RowColumns<landing::Sample>& trajectory_columns();

}  // namespace ukemi::tools
