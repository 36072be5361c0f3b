// Plain HTML reports: headings, tables and line plots as inline SVG, one file, nothing fetched.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/report/table.hpp"

namespace ukemi::tools {

struct Series {
  std::string name;
  std::vector<double> x, y;
};

/// Values on a grid, row by row from the smallest y; NaN is left white.
struct Heatmap {
  std::string x_label, y_label;
  std::vector<double> x, y, values;
};

enum class Axes { kLinear, kLogarithmic };

class Report {
 public:
  explicit Report(const std::string& title);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  void table(const Table& table) { this->table(table.headings(), table.shown()); }
  /// Lines; on logarithmic axes only what is above zero. Returns them as an SVG that stands alone; empty where there is
  /// no range to draw.
  std::string plot(const std::string& x_label, const std::string& y_label, std::vector<Series> series,
                   Axes axes = Axes::kLinear);
  /// Colours from the smallest value (dark) to the 90th percentile (light); the scale is printed beside it. Returns it
  /// as `plot` does.
  std::string heatmap(const Heatmap& map);
  /// The page, closed by the provenance.
  std::string html(const std::vector<std::pair<std::string, std::string>>& provenance);

 private:
  std::string html_;
};

/// Tells a table on the terminal and in the report, with a name as that file too; the value is for the summary.
Json tell(const Table& table, Report& report, Run& run, const std::string& csv = "", const std::string& comment = "");

}  // namespace ukemi::tools
