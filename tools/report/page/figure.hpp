// Figures of curves, points and bars, drawn by gnuplot: all figures of a report by one process. A figure is described
// by what it shows; gnuplot chooses ticks, the layout here says where each panel stands.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ukemi::tools {

enum class Axes { kLinear, kLogarithmic };

/// Points that are drawn alike; what is not finite interrupts a line.
struct Series {
  std::string name;  ///< in the key; empty: not in it
  std::vector<double> x, y;
  enum class Look {
    kLine,
    kDashed,
    kFaint,      ///< a thin line behind the others
    kPoints,     ///< dots
    kIntervals,  ///< dots at (x, y) with bars from `low` to `high` along x
    kBars,       ///< bars along x, from zero to x, about y
    kThick,      ///< links of a robot
  } look = Look::kLine;
  int colour = -1;  ///< of the palette, kInk; -1: the next one
  std::vector<double> low{}, high{};

  static constexpr int kInk = 100, kGrey = 101;  ///< of the text; of the grid
};

/// A number or a name at a point.
struct Mark {
  double x, y;
  std::string text;
  int colour = Series::kInk;
};
/// A line across the panel at a value of y, with its name at the right end.
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
  std::optional<std::array<double, 2>> x_range, y_range;  ///< absent: of the data
  std::vector<std::string> rows;  ///< names of y = 1, 2, ... in place of ticks, the first on top
  enum class Scale {
    kFree,
    kEqual,
    kBare
  } scale = Scale::kFree;  ///< kEqual: a metre is as long in x as in y; kBare:
                           ///< and no axes
};

struct Figure {
  std::string name;     ///< of its file: "acceleration"
  std::string caption;  ///< below it; what it shows, where its data are
  std::vector<Panel> panels;
  int columns = 1;
  enum class Width { kHalf, kWhole } width = Width::kHalf;
  double panel_height = 250;                                    ///< [px]
  enum class Cursor { kNone, kTime } cursor = Cursor::kNone;    ///< kTime: x is the time of the animation [s]
  enum class In { kPageAndFile, kFile } in = In::kPageAndFile;  ///< kFile: drawn where files of figures are asked for
  /// Whether there is anything to draw.
  bool empty() const;
};

/// Where a panel stands in its drawing [px], and the ranges that its width and its height show.
struct Place {
  double left, right, top, bottom;
  std::array<double, 2> x, y;
};
struct Drawing {
  std::string svg;                           ///< for a page: follows its colours
  std::vector<Place> places;                 ///< of the panels
  std::map<std::string, std::string> files;  ///< for themselves: "acceleration.svg" -> what it holds
};

/// Draws figures; `formats`: of svg, pdf, png, those that are wanted as files. In the order of the figures; empty where
/// gnuplot is not there or fails, and `why` says it.
std::vector<Drawing> draw(const std::vector<Figure>& figures, const std::vector<std::string>& formats,
                          std::string& why);

/// A figure of one panel.
Figure lines(const std::string& name, const std::string& x_label, const std::string& y_label,
             std::vector<Series> series, Axes axes = Axes::kLinear);

/// The same as an SVG that stands alone. Throws std::runtime_error where gnuplot is not there or fails.
std::string lines_svg(const std::string& x_label, const std::string& y_label, std::vector<Series> series);

/// At most some 3 `most` of a line's points: the first, the smallest and the largest y of each of `most` equal parts,
/// so that no peak is lost. x rises.
Series thinned(const Series& line, std::size_t most = 700);

}  // namespace ukemi::tools
