#include "tools/bench/reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

const std::string& text(const CsvTable& table, const char* name, std::size_t row) {
  return table.texts[std::size_t(table.require(name))][row];
}

/// The numbers of a cell, separated by semicolons.
std::vector<double> numbers(const CsvTable& table, const char* name, std::size_t row) {
  std::vector<double> out;
  std::istringstream list(text(table, name, row));
  for (std::string cell; std::getline(list, cell, ';');) {
    char* end = nullptr;
    out.push_back(std::strtod(cell.c_str(), &end));
    if (cell.empty() || *end != 0 || !std::isfinite(out.back()))
      throw InputError(table.at(table.require(name), row), quoted(cell) + ": a number is needed");
  }
  return out;
}

}  // namespace

std::vector<ReferenceCase> read_reference(const std::string& folder) {
  const auto read = [&](const char* name, const std::vector<std::string>& texts) {
    const auto is_number = [&](const std::string& column) {
      return std::find(texts.begin(), texts.end(), column) == texts.end();
    };
    const CsvTable table = read_csv(folder + "/" + name, is_number, NanCells::kRefused, texts);
    for (std::size_t c = 0; c < table.header.size(); ++c)
      if (is_number(table.header[c])) table.require_full(int(c));
    return table;
  };
  const CsvTable cases = read("landing_cases.csv", {"id"}),
                 peaks = read("landing_peaks.csv", {"id", "touchdown_order", "touchdown_times"});
  std::vector<ReferenceCase> out;
  for (std::size_t row = 0; row < cases.rows(); ++row) {
    const auto value = [&](const char* name) { return cases.columns[std::size_t(cases.require(name))][row]; };
    ReferenceCase c;
    c.id = text(cases, "id", row);
    if (row >= peaks.rows() || text(peaks, "id", row) != c.id)
      throw InputError({folder + "/landing_peaks.csv"}, "no row " + std::to_string(row + 1) + " of " + quoted(c.id) +
                                                            ": the rows of landing_cases.csv are needed, in order");
    c.scene.name = "reference";
    c.scene.robot = {{value("m0"), value("m1")}, {value("I0"), value("I1")}, value("l"), value("g")};
    c.scene.contacts = {true, true, true};
    c.scene.floor = Floor<double>{value("K_f"), value("C_fy"), value("C_fx")};
    c.scene.drop = {value("height"), value("forward_speed"), value("pitch_deg") * kDegree};
    c.scene.t_end = value("t_end");
    c.sea = {value("k_p"), value("k_d"), value("k_sea"), value("c_sea"), value("i_motor"), value("tau_max")};
    c.motion = {value("phi_i_deg") * kDegree, value("phi_f_deg") * kDegree, value("duration")};
    c.peak = peaks.columns[std::size_t(peaks.require("peak_acc"))][row];
    c.t_peak = peaks.columns[std::size_t(peaks.require("t_peak"))][row];
    c.order = text(peaks, "touchdown_order", row);
    c.touchdowns = numbers(peaks, "touchdown_times", row);
    out.push_back(c);
  }
  return out;
}

}  // namespace ukemi::landing
