// Trajectories of landings as CSV: trajectory.csv and PlotJuggler's.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "landing/body/body_run.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// A column of both files; `Row` has a time `t`.
template <class Row>
struct RowColumn {
  std::string name;              ///< in trajectory.csv
  std::string plotjuggler_name;  ///< path in PlotJuggler's tree, with the unit
  std::function<double(const Row&)> value;
};
template <class Row>
using RowColumns = std::vector<RowColumn<Row>>;

/// `csv` with a header of the columns' `name` and the rows appended.
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

/// CSV for PlotJuggler, which takes no `#` lines and no equal times: the second row of an event is one ulp later. Names
/// have '/', units and no blanks.
template <class Row>
std::string plotjuggler_csv(const RowColumns<Row>& columns, std::vector<Row> rows) {
  double previous = -std::numeric_limits<double>::infinity();
  for (Row& r : rows) {
    if (r.t <= previous) r.t = std::nextafter(previous, std::numeric_limits<double>::infinity());
    previous = r.t;
  }
  return rows_csv({}, columns, &RowColumn<Row>::plotjuggler_name, rows);
}

const RowColumns<landing::Sample>& trajectory_columns();
RowColumns<landing::BodySample> trajectory_columns(const landing::Robot& robot);

}  // namespace ukemi::tools
