// HTML reports in one self-contained file: headings, tables, figures and the animation of landings.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/report/first_screen.hpp"
#include "tools/report/page/figure.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

/// Values on a grid, row by row from the smallest y; NaN is left white.
struct Heatmap {
  std::string x_label, y_label;
  std::vector<double> x, y, values;
  /// A marked point; dx, dy: half the sides of a box around it.
  struct Mark {
    double x, y, dx = 0, dy = 0;
  };
  std::optional<Mark> mark = {};
};

class Report {
 public:
  explicit Report(const std::string& title);
  /// Sets the first screen, shown above everything else; `warnings`: those given to `distrust`.
  void answer(const FirstScreen& screen, const std::vector<std::string>& warnings);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// A line that begins with a link to a file in the page's folder.
  void link(const std::string& file, const std::string& name, const std::string& text);
  void list(const std::vector<std::string>& items);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  void table(const Table& table) { this->table(table.headings(), table.shown()); }
  /// A table folded under a title.
  void folded(const std::string& title, const Table& table);
  /// Numbers from -1 to 1 on coloured cells; NaN is left empty.
  void matrix(const std::vector<std::string>& names, const std::vector<std::vector<double>>& rows);
  /// Section "What to distrust": warnings, a sentence each.
  void distrust(const std::vector<std::string>& sentences);
  /// Adds a figure, drawn with all others by `files`. Long lines are thinned so that no peak is lost; an empty figure
  /// is left out. Throws std::logic_error where the name is in use.
  void figure(Figure figure);
  /// A figure of lines, with `name` as its file.
  void plot(const std::string& name, const std::string& x_label, const std::string& y_label, std::vector<Series> series,
            Axes axes = Axes::kLinear);
  /// Adds a heat map, dark at the smallest value, light from the 90th percentile on, with a colour scale; script.js
  /// shows the value under the pointer. Returns it as an SVG.
  std::string heatmap(const Heatmap& map);
  /// Adds the animation: {"landings": [...]}, see animation.hpp.
  void player(const Json& landings);
  /// Contents by name: report.html, if the run writes one, with the run's provenance; each figure in the run's formats
  /// and in `formats`. `missing`: why gnuplot drew none, else empty.
  std::map<std::string, std::string> files(const Run& run, std::vector<std::string> formats = {},
                                           std::string* missing = nullptr) const;
  /// Adds files() to the run and warns of missing figures.
  void write(Run& run, const std::vector<std::string>& formats = {}) const;

 private:
  std::string& body();  ///< where to append what is no figure

  std::string title_, answer_, html_;
  std::vector<Figure> figures_, in_files_;  ///< of the page; of files only
  bool in_figures_ = false;
};

/// Prints a table, adds it to the report and, with a name `csv`, to the run's files. Returns it for the summary.
Json add_table(const Table& table, Report& report, Run& run, const std::string& csv = "",
               const std::string& comment = "");

}  // namespace ukemi::tools
