#include "tools/report/page/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <regex>
#include <stdexcept>

#include "common/text.hpp"
#include "common/toml.hpp"
#include "tools/report/page/gnuplot.hpp"
#include "tools/report/page/kept_rows.hpp"
#include "tools/report/page/page.hpp"

namespace ukemi::tools {

namespace {

/// Colours of Okabe and Ito, distinguishable with colour blindness; style.css lightens them on dark.
constexpr std::array<const char*, 6> kPalette = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b07d00", "#56b4e9"};
constexpr double kCharWidth = 6.6, kLineHeight = 16;  ///< of a character and of a line of text [px]

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void extend(double x) {
    if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
  }
  bool valid() const { return low <= high; }
};

std::string gnuplot_label(const std::string& text) { return gnuplot_text(printed(text)); }

double char_count(const std::string& text) {
  return double(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

bool drawable(double v, Axes axes) { return std::isfinite(v) && (axes == Axes::kLinear || v > 0); }

/// Range of the data, widened in y; on logarithmic axes by a factor.
Range range_of(const Panel& p, bool along_x) {
  Range out;
  for (const Series& s : p.series) {
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (drawable(s.x[i], p.axes) && drawable(s.y[i], p.axes)) out.extend(along_x ? s.x[i] : s.y[i]);
    if (along_x)
      for (const auto* bar : {&s.low, &s.high})
        for (const double x : *bar) out.extend(x);
    if (along_x && s.style == Series::Style::kBars) out.extend(0);
  }
  if (!along_x)
    for (const Level& l : p.levels) out.extend(l.y);
  if (!out.valid()) return out;
  if (p.axes == Axes::kLogarithmic) return {out.low / 1.3, out.high * 1.3};
  const double span = out.high - out.low, room = span > 0 ? span : std::max(1e-12, std::abs(out.low));
  if (along_x && span > 0 && p.rows.empty()) return out;
  const double above = p.marks.empty() || along_x ? 0.06 : 0.14;  // marks are above their points
  return {out.low < 0 || p.axes == Axes::kLinear ? out.low - 0.05 * room : out.low, out.high + above * room};
}

std::array<double, 2> shown_range(const Panel& p, bool along_x) {
  if (const auto& given = along_x ? p.x_range : p.y_range) return *given;
  if (!along_x && !p.rows.empty()) return {0.4, double(p.rows.size()) + 0.6};
  const Range r = range_of(p, along_x);
  return {r.low, r.high};
}

/// Layout of the key: as many entries side by side as fit.
struct Key {
  int columns = 1, rows = 0;
};
Key key_of(const Panel& p, double width) {
  double longest = 0;
  int entries = 0;
  for (const Series& s : p.series)
    if (!s.name.empty()) ++entries, longest = std::max(longest, char_count(s.name));
  if (entries == 0) return {};
  const int columns = std::clamp(int(width / (longest * kCharWidth + 46)), 1, entries);
  return {columns, (entries + columns - 1) / columns};
}

struct Canvas {
  double width, height;
};
Canvas canvas(const Figure& f) {
  const int rows = (int(f.panels.size()) + f.columns - 1) / f.columns;
  return {f.width == Figure::Width::kWhole ? 980.0 : 480.0, rows * f.panel_height};
}

PanelArea area_of(const Figure& f, std::size_t i) {
  const Panel& p = f.panels[i];
  const Canvas c = canvas(f);
  const int column = int(i) % f.columns, row = int(i) / f.columns;
  const double width = c.width / f.columns, x = width * column, y = f.panel_height * row;
  double left = 62;
  for (const std::string& name : p.rows) left = std::max(left, char_count(name) * kCharWidth + 14);
  if (p.scale == Panel::Scale::kBare) left = 6;
  PanelArea out{x + left,
                x + width - 14,
                y + 8,
                y + f.panel_height - (p.x_label.empty() ? 24 : 44),
                shown_range(p, true),
                shown_range(p, false)};
  if (!p.title.empty()) out.top += kLineHeight;
  out.top += kLineHeight * key_of(p, out.right - out.left).rows;
  return out;
}

std::string colour_of(int colour) {
  if (colour == Series::kInk) return "black";
  if (colour == Series::kGrey) return "#8a8a8a";
  return kPalette[std::size_t(colour) % kPalette.size()];
}

std::string plot_style(const Series& s, int colour) {
  using Style = Series::Style;
  const std::string ink =
      "lc rgb '" + colour_of(s.style == Style::kFaint && s.colour < 0 ? Series::kGrey : colour) + "'";
  switch (s.style) {
    case Style::kLine:
      return "using 1:2 with lines lw 1.6 " + ink;
    case Style::kDashed:
      return "using 1:2 with lines lw 1.6 dt (7,4) " + ink;
    case Style::kFaint:
      return "using 1:2 with lines lw 0.7 " + ink;
    case Style::kThick:
      return "using 1:2 with linespoints lw 4 pt 7 ps 0.5 " + ink;
    case Style::kPoints:
      return "using 1:2 with points pt 7 ps 0.4 " + ink;
    case Style::kIntervals:
      return "using 1:2:3:4 with xerrorbars lw 1.6 pt 7 ps 0.7 " + ink;
    case Style::kBars:
      return "using (0):2:(0):1:($2-0.3):($2+0.3) with boxxyerror fill solid 0.75 noborder " + ink;
  }
  return "";
}

/// The data of a series as a gnuplot datablock; a blank line interrupts the curve.
std::string block(const Series& s, Axes axes, const std::string& name) {
  std::string out = "$" + name + " << END\n";
  bool gap = true;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    const bool is_drawable = drawable(s.x[i], axes) && drawable(s.y[i], axes);
    if (is_drawable)
      out += s.style == Series::Style::kIntervals && !s.low.empty()
                 ? fmt::format("{:.7g} {:.7g} {:.7g} {:.7g}\n", s.x[i], s.y[i], s.low[i], s.high[i])
                 : fmt::format("{:.7g} {:.7g}\n", s.x[i], s.y[i]);
    else if (!gap)
      out += "\n";
    gap = !is_drawable;
  }
  return out + "END\n";
}

/// Bounding box of a text in a panel [px].
struct Box {
  double x, y, width, height;  ///< (x, y): centre
  bool covers(const Box& o) const {
    return std::abs(x - o.x) < 0.5 * (width + o.width) && std::abs(y - o.y) < 0.5 * (height + o.height);
  }
};

/// Map from a panel's coordinates to pixels of its canvas, from the top left.
struct Pixels {
  PanelArea area;
  Axes axes;
  static double fraction(double v, const std::array<double, 2>& range, Axes axes) {
    return axes == Axes::kLinear ? (v - range[0]) / (range[1] - range[0])
                                 : std::log(v / range[0]) / std::log(range[1] / range[0]);
  }
  double px(double v) const { return area.left + fraction(v, area.x, axes) * (area.right - area.left); }
  double py(double v) const { return area.bottom - fraction(v, area.y, axes) * (area.bottom - area.top); }
};

std::string label_at(const std::string& text, double x, double y, const Canvas& c, const std::string& how) {
  return fmt::format("set label {} at screen {:.5f},{:.5f} {} front\n", gnuplot_label(text), x / c.width,
                     1 - y / c.height, how);
}

/// The position nearest to `preferred` that overlaps no `taken` box and is within the panel.
Box free_box(const Box& preferred, const std::vector<Box>& taken, const PanelArea& at) {
  for (int ring = 0; ring < 8; ++ring)
    for (int up = ring; up >= 0; --up)
      for (const int side : {1, -1}) {
        const Box b{preferred.x + side * (ring - up) * 8.0, preferred.y - up * 8.0, preferred.width, preferred.height};
        if (b.y > at.top - 6 && b.x > at.left && b.x < at.right &&
            std::none_of(taken.begin(), taken.end(), [&](const Box& t) { return t.covers(b); }))
          return b;
      }
  return preferred;
}

std::string levels_and_marks(const Panel& p, const Pixels& to, const Canvas& c) {
  std::string out;
  std::vector<Box> taken;
  for (const Level& l : p.levels) {
    if (!(l.y >= to.area.y[0] && l.y <= to.area.y[1])) continue;
    out += fmt::format(
        "set arrow from graph 0,first {0:.7g} to graph 1,first {0:.7g} nohead lw 1.2 dt (3,3) lc rgb 'black'\n", l.y);
    const double width = char_count(l.name) * kCharWidth, above = to.py(l.y) - 10,
                 y = above < to.area.top + 4 ? above + 20 : above;
    taken.push_back({to.area.right - 6 - width / 2, y, width, 14});
    out += label_at(l.name, to.area.right - 6, y, c, "right");
  }
  const bool bare = p.scale == Panel::Scale::kBare;  // positions are given by the caller
  for (const Mark& m : p.marks) {
    if (!bare && !(m.x >= to.area.x[0] && m.x <= to.area.x[1])) continue;
    if (bare) {
      out += fmt::format("set label {} at {:.7g},{:.7g} center front\n", gnuplot_label(m.text), m.x, m.y);
      continue;
    }
    const Box box = free_box({to.px(m.x), to.py(m.y) - 11, char_count(m.text) * kCharWidth + 8, 17}, taken, to.area);
    taken.push_back(box);
    out += label_at(m.text, box.x, box.y, c, "center tc rgb '" + colour_of(m.colour) + "'");
  }
  return out;
}

/// A tick step of 1, 2 or 5 times a power of ten, about `apart` pixels.
double tick_step(const std::array<double, 2>& range, double pixels, double apart) {
  const double raw = (range[1] - range[0]) / std::max(2.0, std::floor(pixels / apart)),
               power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double m : {1.0, 2.0, 5.0})
    if (m * power >= raw) return m * power;
  return 10 * power;
}

/// A name as a tick label; gnuplot takes labels as format strings.
std::string tick_label(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == '%' ? "%%" : std::string(1, c);
  return gnuplot_label(out);
}

std::string axes_of(const Panel& p, const Pixels& to) {
  if (p.scale == Panel::Scale::kBare) return "unset border\nunset xtics\nunset ytics\nunset grid\n";
  const bool log = p.axes == Axes::kLogarithmic;
  const auto step = [&](const std::array<double, 2>& range, double pixels, double apart) {
    return log ? std::string("autofreq") : fmt::format("{:.9g}", tick_step(range, pixels, apart));
  };
  std::string out = "set border 3 lw 0.8\nset grid lt 1 lw 0.5 lc rgb '#c8c8c8'\nset xtics nomirror scale 0.5 " +
                    step(to.area.x, to.area.right - to.area.left, 62) + "\n";
  if (p.rows.empty())
    out += "set ytics nomirror scale 0.5 " + step(to.area.y, to.area.bottom - to.area.top, 24) + "\n";
  else {
    out += "set ytics nomirror scale 0 (";
    for (std::size_t i = 0; i < p.rows.size(); ++i)
      out += fmt::format("{}{} {}", i ? ", " : "", tick_label(p.rows[i]), p.rows.size() - i);
    out += ")\n";
  }
  return (log ? "set logscale xy\n" : "unset logscale\n") + out;
}

/// Title, axis labels and key of a panel.
std::string titles_and_key(const Panel& p, const PanelArea& at, const Canvas& c, double left) {
  const Key key = key_of(p, at.right - at.left);
  std::string out = label_at(p.x_label, (at.left + at.right) / 2, at.bottom + 33, c, "center") +
                    label_at(p.y_label, left + 9, (at.top + at.bottom) / 2, c, "center rotate by 90");
  if (!p.title.empty()) out += label_at(p.title, at.left, at.top - kLineHeight * (key.rows + 0.5) - 2, c, "left");
  if (key.rows == 0) return out + "set key off\n";
  return out + fmt::format(
                   "set key at screen {:.5f},{:.5f} left bottom horizontal Left reverse samplen 1.6 width 0 maxcols {} "
                   "maxrows {}\n",
                   at.left / c.width, 1 - (at.top - 3) / c.height, key.columns, key.rows);
}

/// `left`: of the panel with its axis [px].
std::string script_of(const Panel& p, const PanelArea& at, const Canvas& c, const std::string& name, double left) {
  const Pixels to{at, p.axes};
  std::string out = "unset label\nunset arrow\nset format xy '%g'\n" + axes_of(p, to);
  out += fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset tmargin at screen {:.5f}\nset bmargin at screen "
      "{:.5f}\nset xrange [{:.9g}:{:.9g}]\nset yrange [{:.9g}:{:.9g}]\n",
      at.left / c.width, at.right / c.width, 1 - at.top / c.height, 1 - at.bottom / c.height, at.x[0], at.x[1], at.y[0],
      at.y[1]);
  out += p.scale == Panel::Scale::kFree ? "set size noratio\n" : "set size ratio -1\n";
  out += titles_and_key(p, at, c, left) + levels_and_marks(p, to, c);
  std::string plots;
  int next = 0;
  for (std::size_t i = 0; i < p.series.size(); ++i) {
    const Series& s = p.series[i];
    const int colour = s.colour >= 0 || s.style == Series::Style::kFaint ? s.colour : next++;
    const std::string data = fmt::format("{}_{}", name, i);
    out += block(s, p.axes, data);
    plots += fmt::format("{}${} {} title {}", i ? ", " : "", data, plot_style(s, colour),
                         s.name.empty() ? "''" : gnuplot_label(s.name));
  }
  return out + (plots.empty() ? "" : "plot " + plots + "\n");
}

std::string script_of(const Figure& f, const std::string& name) {
  const Canvas c = canvas(f);
  std::string out = "set multiplot\n";
  for (std::size_t i = 0; i < f.panels.size(); ++i)
    if (!f.panels[i].series.empty())
      out += script_of(f.panels[i], area_of(f, i), c, fmt::format("{}_{}", name, i),
                       c.width / f.columns * double(int(i) % f.columns));
  return out + "unset multiplot\n";
}

std::string terminal(const std::string& format, const Canvas& c) {
  if (format == "pdf")  // sizes are in pixels of 1/96 inch
    return fmt::format("set terminal pdfcairo noenhanced font 'sans-serif,9' size {:.3f}in,{:.3f}in\n", c.width / 96,
                       c.height / 96);
  if (format == "png")
    return fmt::format(
        "set terminal pngcairo noenhanced font 'sans-serif,9' fontscale 2 linewidth 2 size {:.0f},{:.0f}\n",
        2 * c.width, 2 * c.height);
  return fmt::format("set terminal svg noenhanced font 'sans-serif,12' size {:.0f},{:.0f}\n", c.width, c.height);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Replaces gnuplot's id of a curve, gnuplot_plot_3b for the third of the second panel, by data-curve="1,2".
void name_curves(std::string& svg) {
  const std::string begin = " id=\"gnuplot_", curve = "plot_";
  for (std::size_t at = 0; (at = svg.find(begin, at)) != std::string::npos;) {
    const std::size_t end = svg.find('"', at + begin.size());
    const std::string name = svg.substr(at + begin.size(), end - at - begin.size());
    std::string id;
    if (name.starts_with(curve)) {
      const int number = std::atoi(name.c_str() + curve.size());
      id = fmt::format(" data-curve=\"{},{}\"", name.back() - 'a', number - 1);
    }
    svg.replace(at, end + 1 - at, id);
  }
}

/// gnuplot's SVG for a page: text and axes take the page's colour; ids, which could collide with other figures, are
/// removed.
std::string svg_for_page(std::string svg) {
  svg.erase(0, std::min(svg.size(), svg.find("<svg")));
  for (const char* quote : {"\"", "'"}) {
    const std::string q = quote;
    for (const char* attribute : {"stroke=", "fill="})
      replace_all(svg, attribute + q + "black" + q, attribute + q + "currentColor" + q);
    replace_all(svg, "color=" + q + "black" + q, "");
  }
  for (const char* ink : {"rgb(  0,   0,   0)", "rgb(0,0,0)"}) replace_all(svg, ink, "currentColor");
  for (const char* part : {"<title>", "<desc>"}) {
    const std::string begin = part, end = "</" + begin.substr(1);
    for (std::size_t at = 0; (at = svg.find(begin, at)) != std::string::npos;)
      svg.erase(at, svg.find(end, at) + end.size() - at);
  }
  name_curves(svg);
  replace_all(svg, "\t", " ");
  svg = std::regex_replace(svg, std::regex("<g [^>]*>\\s*</g>\\s*"), "");  // empty groups
  return svg;
}

}  // namespace

bool Figure::empty() const {
  return panels.empty() || std::none_of(panels.begin(), panels.end(), [](const Panel& p) {
           const auto x = shown_range(p, true), y = shown_range(p, false);
           return x[0] < x[1] && y[0] < y[1];
         });
}

Series thinned(const Series& line, std::size_t parts) {
  Series out = line;
  out.x.clear(), out.y.clear();
  for (const std::size_t i : kept_rows({&line.y}, parts)) out.x.push_back(line.x[i]), out.y.push_back(line.y[i]);
  return out;
}

std::vector<Drawing> draw(const std::vector<Figure>& figures, const std::vector<std::string>& formats,
                          std::string& why) {
  if (figures.empty()) return {};
  std::string script = "set encoding utf8\n";
  std::vector<std::string> names;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    std::vector<std::string> all_formats = {"svg"};
    for (const std::string& format : formats)
      if (format != "svg") all_formats.push_back(format);
    for (const std::string& format : all_formats) {
      names.push_back(figures[i].name + "." + format);
      script += terminal(format, canvas(figures[i])) + "set output '" + names.back() + "'\n" +
                script_of(figures[i], fmt::format("f{}{}", i, format)) + "unset output\n";
    }
  }
  std::map<std::string, std::string> files = gnuplot(script, names, why);
  std::vector<Drawing> out;
  for (std::size_t i = 0; i < figures.size() && !files.empty(); ++i) {
    Drawing& d = out.emplace_back();
    const std::string& name = figures[i].name;
    d.svg = svg_for_page(files.at(name + ".svg"));
    for (std::size_t k = 0; k < figures[i].panels.size(); ++k) d.areas.push_back(area_of(figures[i], k));
    for (const std::string& format : formats) d.files[name + "." + format] = std::move(files.at(name + "." + format));
  }
  return out;
}

Figure lines(const std::string& name, const std::string& x_label, const std::string& y_label,
             std::vector<Series> series, Axes axes) {
  Panel panel;
  panel.x_label = x_label, panel.y_label = y_label, panel.series = std::move(series), panel.axes = axes;
  Figure out;
  out.name = name, out.panels = {panel};
  return out;
}

std::string lines_svg(const std::string& x_label, const std::string& y_label, std::vector<Series> series) {
  std::string why;
  std::vector<Drawing> drawn = draw({lines("figure", x_label, y_label, std::move(series))}, {"svg"}, why);
  if (drawn.empty()) throw std::runtime_error("no figure: " + why);
  return drawn.front().files.begin()->second;
}

}  // namespace ukemi::tools
