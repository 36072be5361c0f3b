#include "tools/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "tools/report/page/origin.hpp"
#include "tools/report/page/page.hpp"

namespace ukemi::tools {

namespace {

/// Stands for a figure until it is drawn: a control character, which no shown text has.
std::string placeholder(std::size_t figure) { return fmt::format("\x01{}\x02", figure); }

/// Limit of the rows that a page shows of a table.
constexpr std::size_t kMostRows = 300;

constexpr const char* kEnd = "</div>\n";

/// Whether curves.js zooms it: curves and points over numeric axes.
bool zoomable(const Panel& p) {
  return p.scale == Panel::Scale::kFree && p.rows.empty() &&
         std::none_of(p.series.begin(), p.series.end(),
                      [](auto& s) { return s.style == Series::Style::kBars || s.style == Series::Style::kIntervals; });
}

Json panel_json(const Panel& p, const PanelArea& at) {
  Json out = {{"left", at.left},
              {"right", at.right},
              {"top", at.top},
              {"bottom", at.bottom},
              {"x", at.x},
              {"y", at.y},
              {"log", p.axes == Axes::kLogarithmic},
              {"title", p.title},
              {"x_label", p.x_label},
              {"y_label", p.y_label},
              {"names", Json::array()},
              {"marks", Json::array()},
              {"levels", Json::array()}};
  for (const Series& s : p.series) out["names"].push_back(s.name);
  for (const Mark& m : p.marks) out["marks"].push_back({m.x, m.y, m.text});
  for (const Level& l : p.levels) out["levels"].push_back({l.y, l.name});
  return out;
}

/// The drawn panels in order, for curves.js; null: not zoomable. Empty text where no panel is zoomable.
std::string panels_json(const Figure& f, const Drawing& d) {
  Json out = Json::array();
  bool any = false;
  for (std::size_t i = 0; i < f.panels.size(); ++i) {
    if (f.panels[i].series.empty()) continue;
    any |= zoomable(f.panels[i]);
    out.push_back(zoomable(f.panels[i]) ? panel_json(f.panels[i], d.areas[i]) : Json());
  }
  return any ? printed(out.dump(-1, ' ', false, Json::error_handler_t::replace)) : "";
}

/// Opening tag of a figure.
std::string opening(const Figure& f, const Drawing& d) {
  std::string out = "<figure id=\"figure-" + escaped(f.name) + "\"";
  if (f.width == Figure::Width::kWhole) out += " class=\"whole\"";
  if (f.cursor == Figure::Cursor::kTime) out += " data-time";
  if (const std::string panels = panels_json(f, d); !panels.empty()) out += " data-panels=\"" + escaped(panels) + "\"";
  return out + ">";
}

std::string element(const Figure& f, const Drawing& d) {
  std::string svg = d.svg;
  std::string description = f.caption.empty() ? f.name : f.caption;
  for (const Panel& p : f.panels)
    if (f.panels.size() == 1) description = p.y_label + " against " + p.x_label + ". " + f.caption;
  svg.replace(0, 4, "<svg role=\"img\" aria-label=\"" + escaped(description) + "\"");
  std::string out = opening(f, d) + "<div class=\"drawing\">" + svg + "</div>";
  if (!f.caption.empty()) out += "<figcaption>" + prose(f.caption) + "</figcaption>";
  return out + "</figure>\n";
}

}  // namespace

Report::Report(const std::string& title) : title_(title) {}

std::string& Report::body() {
  if (in_figures_) html_ += kEnd;
  in_figures_ = false;
  return html_;
}
void Report::answer(const FirstScreen& screen, const std::vector<std::string>& warnings) {
  answer_ = html(screen, warnings.size());
}
void Report::heading(const std::string& text) { body() += "<h2>" + prose(text) + "</h2>\n"; }
void Report::paragraph(const std::string& text) { body() += "<p>" + prose(text) + "</p>\n"; }
void Report::link(const std::string& file, const std::string& name, const std::string& text) {
  body() += "<p><a href=\"" + escaped(file) + "\">" + escaped(name) + "</a> " + prose(text) + "</p>\n";
}
void Report::list(const std::vector<std::string>& items) {
  if (items.empty()) return;
  body() += "<ul>";
  for (const std::string& i : items) html_ += "<li>" + prose(i) + "</li>";
  html_ += "</ul>\n";
}
void Report::distrust(const std::vector<std::string>& sentences) {
  if (sentences.empty()) return;  // the checklist says so
  body() += "<section class=\"doubt\"><h2>What to distrust</h2>\n";
  list(sentences);
  html_ += "</section>\n";
}
void Report::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  body() += "<div class=\"table\"><table><thead><tr>";
  for (const std::string& h : header) html_ += "<th scope=\"col\">" + prose(h) + "</th>";
  html_ += "</tr></thead>\n";
  const std::size_t shown = std::min(rows.size(), kMostRows);
  for (std::size_t i = 0; i < shown; ++i) {
    html_ += "<tr>";
    for (const std::string& cell : rows[i]) html_ += "<td>" + prose(cell) + "</td>";
    html_ += "</tr>\n";
  }
  html_ += "</table></div>\n";
  if (shown < rows.size()) paragraph(fmt::format("{} more rows: summary.json.", rows.size() - shown));
}
void Report::folded(const std::string& title, const Table& t) {
  body() += "<details><summary>" + prose(title) + "</summary>\n";
  table(t);
  html_ += "</details>\n";
}
void Report::matrix(const std::vector<std::string>& names, const std::vector<std::vector<double>>& rows) {
  body() += "<div class=\"table\"><table class=\"colours\"><thead><tr><th></th>";
  for (const std::string& n : names) html_ += "<th scope=\"col\">" + escaped(n) + "</th>";
  html_ += "</tr></thead>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    html_ += "<tr><td>" + escaped(names[i]) + "</td>";
    for (const double v : rows[i]) {
      // From white at 0 to blue at -1 and orange at 1.
      const std::array<int, 3> colour = v < 0 ? std::array{86, 180, 233} : std::array{230, 159, 0};
      const double fraction = std::isfinite(v) ? std::min(1.0, std::abs(v)) : 0;
      const auto blend = [&](int c) { return int(std::lround(255 + fraction * (c - 255))); };
      html_ += std::isfinite(v) ? fmt::format("<td style=\"background:rgb({},{},{})\">{:.2f}</td>", blend(colour[0]),
                                              blend(colour[1]), blend(colour[2]), v)
                                : "<td></td>";
    }
    html_ += "</tr>\n";
  }
  html_ += "</table></div>\n";
}

void Report::figure(Figure f) {
  if (f.empty()) return;
  for (const std::vector<Figure>* const all : {&figures_, &in_files_})
    for (const Figure& other : *all)
      if (other.name == f.name) throw std::logic_error(f.name + ": two figures of one name");
  constexpr std::size_t kMaxParts = 6000, kMinLineParts = 100,
                        kMaxLineParts = 700;  // of a figure, of a line
  std::size_t lines = 0;
  for (const Panel& p : f.panels) lines += p.series.size();
  for (Panel& p : f.panels)
    for (Series& s : p.series)
      if (s.low.empty()) s = thinned(s, std::clamp(kMaxParts / lines, kMinLineParts, kMaxLineParts));
  if (f.target == Figure::Target::kFile) return in_files_.push_back(std::move(f));
  if (!in_figures_) html_ += "<div class=\"figures\">\n";
  in_figures_ = true;
  html_ += placeholder(figures_.size());
  figures_.push_back(std::move(f));
}
void Report::plot(const std::string& name, const std::string& x_label, const std::string& y_label,
                  std::vector<Series> series, Axes axes) {
  figure(lines(name, x_label, y_label, std::move(series), axes));
}
void Report::player(const Json& landings) {
  body() +=
      "<div class=\"player\" id=\"player\"><noscript><p>The animation needs the script of this page; the postures and "
      "the figures below show the same.</p></noscript></div>\n" +
      json_block("landings", landings.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::map<std::string, std::string> Report::files(const Run& run, std::vector<std::string> formats,
                                                 std::string* missing) const {
  const bool page_wanted = run.options().report == CommonOptions::Report::kWrite;
  for (const std::string& f : run.options().figures)
    if (std::find(formats.begin(), formats.end(), f) == formats.end()) formats.push_back(f);
  if (!page_wanted && formats.empty()) return {};
  std::string why;
  std::vector<Figure> wanted = figures_;
  if (!formats.empty()) wanted.insert(wanted.end(), in_files_.begin(), in_files_.end());
  const std::vector<Drawing> drawings = draw(wanted, formats, why);
  const auto provenance = run.provenance();
  std::string printed, list;
  for (std::size_t i = 0; i < std::min(provenance.size(), kMostRows); ++i) {
    const std::string line = provenance[i].first + ": " + provenance[i].second;
    printed += line + "\n", list += "<li>" + escaped(line) + "</li>";
  }
  if (provenance.size() > kMostRows)
    list += fmt::format("<li>{} more: summary.json</li>", provenance.size() - kMostRows);
  std::map<std::string, std::string> out;
  std::string text = answer_ + html_ + (in_figures_ ? kEnd : "");
  for (std::size_t i = 0; i < figures_.size(); ++i) {
    const std::string mark = placeholder(i);
    text.replace(text.find(mark), mark.size(), drawings.empty() ? "" : element(figures_[i], drawings[i]));
  }
  for (const Drawing& d : drawings)
    for (const auto& [name, content] : d.files) out[name] = with_origin(name, content, printed);
  if (!why.empty()) text += "<p>The figures are left out: " + escaped(why) + ".</p>\n";
  if (missing) *missing = why;
  text += "<section class=\"provenance\"><h2>Provenance</h2>\n<ul>" + list;
  text += "</ul></section>\n";
  if (page_wanted) out["report.html"] = page(title_, text);
  return out;
}
void Report::write(Run& run, const std::vector<std::string>& formats) const {
  std::string missing;
  for (auto& [name, content] : files(run, formats, &missing)) run.add(name, content);
  if (!missing.empty()) run.warn("the figures are left out: " + missing);
}

namespace {
/// Colour of a value in [0, 1]: dark blue over green to light yellow.
std::string colour(double s) {
  static constexpr double kStops[5][3] = {{28, 20, 70}, {45, 90, 140}, {40, 150, 130}, {130, 200, 90}, {250, 230, 150}};
  const double x = std::clamp(s, 0.0, 1.0) * 4;
  const int i = std::min(3, int(x));
  std::string out = "#";
  for (int c = 0; c < 3; ++c)
    out += fmt::format("{:02x}", int(kStops[i][c] + (x - i) * (kStops[i + 1][c] - kStops[i][c])));
  return out;
}
}  // namespace

namespace {

/// Draws a heat map as an SVG; sizes in pixels.
class HeatmapPicture {
 public:
  explicit HeatmapPicture(const Heatmap& m)
      : map_(m), w_(kInnerW / double(m.x.size())), h_(kInnerH / double(m.y.size())) {
    std::vector<double> sorted;
    for (const double v : m.values)
      if (std::isfinite(v)) sorted.push_back(v);
    if (sorted.empty()) return;
    std::sort(sorted.begin(), sorted.end());
    low_ = sorted.front(), high_ = std::max(sorted[sorted.size() * 9 / 10], low_ * (1 + 1e-9));
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"map\" viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\" "
        "aria-label=\"{} against {}\" font-size=\"12\" font-family=\"sans-serif\" fill=\"currentColor\" "
        "shape-rendering=\"crispEdges\">",
        kWidth, kHeight, kWidth, escaped(m.y_label), escaped(m.x_label));
    draw_cells(), draw_axes(), draw_scale(), draw_mark(), add_values();
    svg_ += "</svg>";
  }
  const std::string& text() const { return svg_; }

 private:
  static constexpr double kWidth = 640, kHeight = 420, kLeft = 70, kBottom = 45, kTop = 25, kRight = 90,
                          kInnerW = kWidth - kLeft - kRight, kInnerH = kHeight - kBottom - kTop;
  static constexpr int kSteps = 48;  // of the colour scale; neighbours of one step are drawn as one rectangle

  void rect(double x, double y, double width, double height, int step) {
    svg_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x, y, width,
                        height, colour(double(step) / kSteps));
  }
  void label(double x, double y, const char* anchor, const std::string& s) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor, prose(s));
  }
  void draw_cells() {
    const std::size_t nx = map_.x.size();
    const auto shade = [&](std::size_t i, std::size_t j) {
      const double v = map_.values[j * nx + i];
      return std::isfinite(v) ? int(std::clamp((v - low_) / (high_ - low_), 0.0, 1.0) * kSteps) : -1;
    };
    for (std::size_t j = 0; j < map_.y.size(); ++j)
      for (std::size_t i = 0; i < nx;) {
        const int step = shade(i, j);
        const std::size_t begin = i;
        while (i < nx && shade(i, j) == step) ++i;
        if (step >= 0)
          rect(kLeft + w_ * double(begin), kTop + kInnerH - h_ * double(j + 1), w_ * double(i - begin), h_ + 0.3, step);
      }
  }
  void draw_axes() {
    for (int q = 0; q <= 4; ++q) {
      const double s = q / 4.0, x = at(map_.x, s), y = at(map_.y, s);
      label(kLeft + pixels(map_.x, x, w_), kTop + kInnerH + 18, "middle", fmt::format("{:.3g}", x));
      label(kLeft - 6, kTop + kInnerH - pixels(map_.y, y, h_) + 4, "end", fmt::format("{:.3g}", y));
      label(kWidth - kRight + 40, kTop + kInnerH * (1 - s) + 4, "start",
            fmt::format("{:.4g}", low_ + s * (high_ - low_)));
    }
    label(kLeft + kInnerW / 2, kHeight - 8, "middle", map_.x_label);
    label(5, 14, "start", map_.y_label);
  }
  static double at(const std::vector<double>& axis, double part) { return std::lerp(axis.front(), axis.back(), part); }
  void draw_scale() {
    for (int q = 0; q < kSteps; ++q)
      rect(kWidth - kRight + 15, kTop + kInnerH * (1 - double(q + 1) / kSteps), 18, kInnerH / kSteps + 0.3, q);
  }
  /// Distance of a value from the axis' start; grid points are centres of cells.
  static double pixels(const std::vector<double>& axis, double v, double cell) {
    const double step = axis.size() > 1 ? (axis.back() - axis.front()) / double(axis.size() - 1) : 1;
    return cell * (0.5 + (v - axis.front()) / step);
  }
  void draw_mark() {
    if (!map_.mark) return;
    const Heatmap::Mark& m = *map_.mark;
    const double x = kLeft + pixels(map_.x, m.x, w_), y = kTop + kInnerH - pixels(map_.y, m.y, h_),
                 dx = pixels(map_.x, m.x + m.dx, w_) - pixels(map_.x, m.x, w_),
                 dy = pixels(map_.y, m.y + m.dy, h_) - pixels(map_.y, m.y, h_);
    svg_ += fmt::format(
        "<g fill=\"none\" stroke=\"#d62728\" stroke-width=\"1.5\"><path d=\"M{0:.1f} {1:.1f}h16M{2:.1f} "
        "{3:.1f}v16\"/><rect x=\"{4:.1f}\" y=\"{5:.1f}\" width=\"{6:.1f}\" height=\"{7:.1f}\"/></g>",
        x - 8, y, x, y - 8, x - dx, y - dy, 2 * dx, 2 * dy);
  }
  /// Data for script.js: position of the axes' box, labels, values.
  void add_values() {
    const auto list = [](const std::vector<double>& v) {
      std::string out = "[";
      for (const double x : v)
        out += (out.size() > 1 ? "," : "") + (std::isfinite(x) ? fmt::format("{:.5g}", x) : "null");
      return out + "]";
    };
    const Json labels = {printed(map_.x_label), printed(map_.y_label)};
    svg_ +=
        fmt::format("<metadata>{{\"inside\":[{},{},{},{}],\"labels\":{},\"x\":{},\"y\":{},\"values\":{}}}</metadata>",
                    kLeft, kTop, kInnerW, kInnerH, escaped(labels.dump(-1, ' ', false, Json::error_handler_t::replace)),
                    list(map_.x), list(map_.y), list(map_.values));
  }

  const Heatmap& map_;
  const double w_, h_;  // of a cell
  double low_ = 0, high_ = 1;
  std::string svg_;
};

}  // namespace

std::string Report::heatmap(const Heatmap& map) {
  std::string svg = HeatmapPicture(map).text();
  if (!svg.empty()) body() += "<div class=\"heat\">" + svg + "</div>\n";
  return svg;
}

Json add_table(const Table& table, Report& report, Run& run, const std::string& csv, const std::string& comment) {
  say(table, run);
  report.table(table);
  if (!csv.empty()) run.add(csv, table.csv(run, comment));
  return table.objects();
}

}  // namespace ukemi::tools
