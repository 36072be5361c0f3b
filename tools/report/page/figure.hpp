// Declarative figures of curves, points and bars. gnuplot draws all figures of a report in one process; the layout of
// panels is computed here.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ukemi::tools {

enum class Axes { kLinear, kLogarithmic };

/// A curve or a set of points; a value that is not finite interrupts a line.
struct Series {
  std::string name;  ///< in the key; empty: not listed
  std::vector<double> x, y;
  enum class Style {
    kLine,
    kDashed,
    kFaint,      ///< a thin line behind the others
    kPoints,     ///< dots
    kIntervals,  ///< dots at (x, y) with bars from `low` to `high` along x
    kBars,       ///< bars along x, from zero to x, about y
    kThick,      ///< links of a robot
  } style = Style::kLine;
  int colour = -1;  ///< index in the palette, kInk or kGrey; -1: the next one
  std::vector<double> low{}, high{};

  static constexpr int kInk = 100, kGrey = 101;  ///< black, as text; grey
};

/// A text at a point.
struct Mark {
  double x, y;
  std::string text;
  int colour = Series::kInk;
};
/// A horizontal line at y with its name at the right end.
struct Level {
  double y;
  std::string name;
};

struct Panel {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  std::vector<Mark> marks;
  std::vector<Level> levels;
  Axes axes = Axes::kLinear;
  std::optional<std::array<double, 2>> x_range, y_range;  ///< absent: from the data
  std::vector<std::string> rows;                          ///< names instead of ticks in y, the first at the top
  enum class Scale {
    kFree,
    kEqual,
    kBare
  } scale = Scale::kFree;  ///< kEqual: the same scale in x and y; kBare: also
                           ///< without axes
};

struct Figure {
  std::string name;     ///< of its file: "acceleration"
  std::string caption;  ///< what it shows, where its data are
  std::vector<Panel> panels;
  int columns = 1;
  enum class Width { kHalf, kWhole } width = Width::kHalf;
  double panel_height = 250;                                  ///< [px]
  enum class Cursor { kNone, kTime } cursor = Cursor::kNone;  ///< kTime: x is the time of the animation [s]
  enum class Target { kPageAndFile, kFile } target = Target::kPageAndFile;  ///< kFile: only if files are requested
  /// Whether there is anything to draw.
  bool empty() const;
};

/// The box of a panel's axes in its drawing [px], and the ranges of x and y that it shows.
struct PanelArea {
  double left, right, top, bottom;
  std::array<double, 2> x, y;
};
struct Drawing {
  std::string svg;                           ///< for a page, whose colours it takes
  std::vector<PanelArea> areas;              ///< of the panels
  std::map<std::string, std::string> files;  ///< contents by name: "acceleration.svg"
};

/// Drawings of figures, in their order; `formats`: of svg, pdf, png, for Drawing::files. Empty where gnuplot is missing
/// or fails; `why` is then the reason.
std::vector<Drawing> draw(const std::vector<Figure>& figures, const std::vector<std::string>& formats,
                          std::string& why);

/// A figure of one panel.
Figure lines(const std::string& name, const std::string& x_label, const std::string& y_label,
             std::vector<Series> series, Axes axes = Axes::kLinear);

/// A figure of one panel as a stand-alone SVG. Throws std::runtime_error where gnuplot is missing or fails.
std::string lines_svg(const std::string& x_label, const std::string& y_label, std::vector<Series> series);

/// Keeps at most about 3 `parts` points of a line: the first, the lowest and the highest of each of `parts` equal
/// parts, so that no peak is lost. x increases.
Series thinned(const Series& line, std::size_t parts = 700);

}  // namespace ukemi::tools
