// HTML reports: headings, tables, figures and the animation of landings, one file, nothing fetched.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/report/first_screen.hpp"
#include "tools/report/page/figure.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

/// Values on a grid, row by row from the smallest y; NaN is left white.
struct Heatmap {
  std::string x_label, y_label;
  std::vector<double> x, y, values;
  /// A point to show, and half the sides of a box about it.
  struct Mark {
    double x, y, dx = 0, dy = 0;
  };
  std::optional<Mark> mark = {};
};

class Report {
 public:
  explicit Report(const std::string& title);
  /// The first screen, wherever it is called: it stands above all else; `warnings` are those that `distrust` shows
  /// further down.
  void answer(const FirstScreen& screen, const std::vector<std::string>& warnings);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// A line that begins with a link to a file beside the page.
  void link(const std::string& file, const std::string& name, const std::string& text);
  void list(const std::vector<std::string>& items);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
  void table(const Table& table) { this->table(table.headings(), table.shown()); }
  /// A table that is folded under a title until the reader opens it.
  void folded(const std::string& title, const Table& table);
  /// Numbers from -1 to 1 as colours, written in them; NaN is left empty.
  void matrix(const std::vector<std::string>& names, const std::vector<std::vector<double>>& rows);
  /// What a reader should know before the numbers are believed, a sentence each, under a heading of its own.
  void distrust(const std::vector<std::string>& sentences);
  /// Drawn with all others by `files`; a name of its own (std::logic_error); long lines are thinned so that no peak is
  /// lost. What has nothing to draw is left out.
  void figure(Figure figure);
  /// A figure of lines, with `name` as its file.
  void plot(const std::string& name, const std::string& x_label, const std::string& y_label, std::vector<Series> series,
            Axes axes = Axes::kLinear);
  /// Colours from the smallest value (dark) to the 90th percentile (light); the scale is printed beside it, and the
  /// page's script reads off the value under the pointer. Returns it as an SVG.
  std::string heatmap(const Heatmap& map);
  /// The animation, for fall.js: {"landings": [...]}, see animation.hpp.
  void player(const Json& landings);
  /// The page, closed by the run's provenance, as report.html where one is wanted, and the figures as files of their
  /// own in the run's formats and in these. Where gnuplot draws none, the page says why, and so does `missing`.
  std::map<std::string, std::string> files(const Run& run, std::vector<std::string> formats = {},
                                           std::string* missing = nullptr) const;
  /// The same, into the run, which warns of figures that are missing.
  void write(Run& run, const std::vector<std::string>& formats = {}) const;

 private:
  std::string& body();  ///< to add something that is no figure

  std::string title_, answer_, html_;
  std::vector<Figure> figures_, in_files_;  ///< of the page; of files alone
  bool in_figures_ = false;
};

/// Tells a table on the terminal and in the report, with a name as that file too; the value is for the summary.
Json add_table(const Table& table, Report& report, Run& run, const std::string& csv = "",
               const std::string& comment = "");

}  // namespace ukemi::tools
