#include "tools/report/estimates.hpp"

#include <fmt/format.h>

namespace ukemi::tools {

Json estimate_json(const identify::Estimate& e) {
  Json j;
  j["value"] = number(e.value);
  j["std"] = number(e.std);
  j["ci95"] = e.std ? Json{e.ci_low, e.ci_high} : Json(nullptr);
  j["unit"] = e.unit;
  j["at_bound"] = e.at_bound;
  j["free"] = e.free;
  return j;
}

std::string text_of(const identify::Estimate& e) {
  if (!e.free) return fmt::format("{:.6g} (fixed)", e.value);
  if (e.at_bound) return fmt::format("{:.6g} (at bound)", e.value);
  if (!e.std) return fmt::format("{:.6g} (not determined)", e.value);
  return fmt::format("{:.6g} ± {:.2g}", e.value, *e.std);
}

std::string interval_of(const identify::Estimate& e) {
  return e.std ? fmt::format("{:.6g} .. {:.6g}", e.ci_low, e.ci_high) : "";
}

Json matrix_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (long i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (long j = 0; j < m.cols(); ++j) row.push_back(number(m(i, j)));
    rows.push_back(row);
  }
  return rows;
}

void add_correlations(Report& report, const std::vector<std::string>& names, const Eigen::MatrixXd& correlation) {
  report.heading("Correlations");
  std::vector<std::string> header = {""};
  header.insert(header.end(), names.begin(), names.end());
  std::vector<std::vector<std::string>> rows;
  for (long i = 0; i < correlation.rows(); ++i) {
    rows.push_back({names[std::size_t(i)]});
    for (long j = 0; j < correlation.cols(); ++j) rows.back().push_back(fmt::format("{:.3f}", correlation(i, j)));
  }
  report.table(header, rows);
}

}  // namespace ukemi::tools
