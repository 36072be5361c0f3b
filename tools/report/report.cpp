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

/// Where a figure will stand: a character that no text shown has.
std::string placeholder(std::size_t figure) { return fmt::format("\x01{}\x02", figure); }

/// What a page shows of a long table; the rest is for programs.
constexpr std::size_t kMostRows = 300;

constexpr const char* kEnd = "</div>\n";

/// Whether a reader may zoom into it: curves and points over axes of numbers.
bool zoomable(const Panel& p) {
  return p.scale == Panel::Scale::kFree && p.rows.empty() &&
         std::none_of(p.series.begin(), p.series.end(),
                      [](auto& s) { return s.look == Series::Look::kBars || s.look == Series::Look::kIntervals; });
}

Json panel_json(const Panel& p, const Place& at) {
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

/// The panels that are drawn, in their order, for curves.js; null: not to be zoomed. Empty: none is.
std::string panels_json(const Figure& f, const Drawing& d) {
  Json out = Json::array();
  bool any = false;
  for (std::size_t i = 0; i < f.panels.size(); ++i) {
    if (f.panels[i].series.empty()) continue;
    any |= zoomable(f.panels[i]);
    out.push_back(zoomable(f.panels[i]) ? panel_json(f.panels[i], d.places[i]) : Json());
  }
  return any ? printed(out.dump(-1, ' ', false, Json::error_handler_t::replace)) : "";
}

/// The class and the data of a figure's element.
std::string opening(const Figure& f, const Drawing& d) {
  std::string out = "<figure id=\"figure-" + escaped(f.name) + "\"";
  if (f.width == Figure::Width::kWhole) out += " class=\"whole\"";
  if (f.cursor == Figure::Cursor::kTime) out += " data-time";
  if (const std::string panels = panels_json(f, d); !panels.empty()) out += " data-panels=\"" + escaped(panels) + "\"";
  return out + ">";
}

std::string element(const Figure& f, const Drawing& d) {
  std::string svg = d.svg;
  std::string described = f.caption.empty() ? f.name : f.caption;
  for (const Panel& p : f.panels)
    if (f.panels.size() == 1) described = p.y_label + " against " + p.x_label + ". " + f.caption;
  svg.replace(0, 4, "<svg role=\"img\" aria-label=\"" + escaped(described) + "\"");
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
  if (sentences.empty()) return;  // the checklist says it
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
      // From white to blue below zero and to orange above it, as far as the number is from zero.
      const std::array<int, 3> end = v < 0 ? std::array{86, 180, 233} : std::array{230, 159, 0};
      const double part = std::isfinite(v) ? std::min(1.0, std::abs(v)) : 0;
      const auto mixed = [&](int c) { return int(std::lround(255 + part * (c - 255))); };
      html_ += std::isfinite(v) ? fmt::format("<td style=\"background:rgb({},{},{})\">{:.2f}</td>", mixed(end[0]),
                                              mixed(end[1]), mixed(end[2]), v)
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
  constexpr std::size_t kMost = 6000, kFewest = 100, kEnough = 700;  // of parts, of a figure and of a line
  std::size_t lines = 0;
  for (const Panel& p : f.panels) lines += p.series.size();
  for (Panel& p : f.panels)
    for (Series& s : p.series)
      if (s.low.empty()) s = thinned(s, std::clamp(kMost / lines, kFewest, kEnough));
  if (f.in == Figure::In::kFile) return in_files_.push_back(std::move(f));
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
      "<div class=\"player\" id=\"player\"><noscript><p>The animation needs the script of this page; the "
      "postures and the figures below show the same.</p></noscript></div>\n" +
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
/// Dark blue over green to light yellow, 0..1.
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

/// A heat map as an SVG: where it stands in the picture, and its parts one after the other.
class HeatmapPicture {
 public:
  explicit HeatmapPicture(const Heatmap& m) : map_(m), w_(kInner / double(m.x.size())), h_(kTall / double(m.y.size())) {
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
    cells(), axes(), scale(), mark(), values();
    svg_ += "</svg>";
  }
  const std::string& text() const { return svg_; }

 private:
  static constexpr double kWidth = 640, kHeight = 420, kLeft = 70, kBottom = 45, kTop = 25, kRight = 90,
                          kInner = kWidth - kLeft - kRight, kTall = kHeight - kBottom - kTop;
  static constexpr int kSteps = 48;  // equal neighbours are drawn as one

  void box(double x, double y, double width, double height, int step) {
    svg_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x, y, width,
                        height, colour(double(step) / kSteps));
  }
  void say(double x, double y, const char* anchor, const std::string& s) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor, prose(s));
  }
  void cells() {
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
          box(kLeft + w_ * double(begin), kTop + kTall - h_ * double(j + 1), w_ * double(i - begin), h_ + 0.3, step);
      }
  }
  void axes() {
    for (int q = 0; q <= 4; ++q) {
      const double s = q / 4.0, x = at(map_.x, s), y = at(map_.y, s);
      say(kLeft + place(map_.x, x, w_), kTop + kTall + 18, "middle", fmt::format("{:.3g}", x));
      say(kLeft - 6, kTop + kTall - place(map_.y, y, h_) + 4, "end", fmt::format("{:.3g}", y));
      say(kWidth - kRight + 40, kTop + kTall * (1 - s) + 4, "start", fmt::format("{:.4g}", low_ + s * (high_ - low_)));
    }
    say(kLeft + kInner / 2, kHeight - 8, "middle", map_.x_label);
    say(5, 14, "start", map_.y_label);
  }
  static double at(const std::vector<double>& axis, double part) { return std::lerp(axis.front(), axis.back(), part); }
  void scale() {
    for (int q = 0; q < kSteps; ++q)
      box(kWidth - kRight + 15, kTop + kTall * (1 - double(q + 1) / kSteps), 18, kTall / kSteps + 0.3, q);
  }
  /// Cells stand about their points: the first point is half a cell inside.
  static double place(const std::vector<double>& axis, double v, double cell) {
    const double step = axis.size() > 1 ? (axis.back() - axis.front()) / double(axis.size() - 1) : 1;
    return cell * (0.5 + (v - axis.front()) / step);
  }
  void mark() {
    if (!map_.mark) return;
    const Heatmap::Mark& m = *map_.mark;
    const double x = kLeft + place(map_.x, m.x, w_), y = kTop + kTall - place(map_.y, m.y, h_),
                 dx = place(map_.x, m.x + m.dx, w_) - place(map_.x, m.x, w_),
                 dy = place(map_.y, m.y + m.dy, h_) - place(map_.y, m.y, h_);
    svg_ += fmt::format(
        "<g fill=\"none\" stroke=\"#d62728\" stroke-width=\"1.5\"><path d=\"M{0:.1f} {1:.1f}h16M{2:.1f} "
        "{3:.1f}v16\"/><rect x=\"{4:.1f}\" y=\"{5:.1f}\" width=\"{6:.1f}\" height=\"{7:.1f}\"/></g>",
        x - 8, y, x, y - 8, x - dx, y - dy, 2 * dx, 2 * dy);
  }
  /// What the script reads: where the picture's inside is, and the numbers.
  void values() {
    const auto list = [](const std::vector<double>& v) {
      std::string out = "[";
      for (const double x : v)
        out += (out.size() > 1 ? "," : "") + (std::isfinite(x) ? fmt::format("{:.5g}", x) : "null");
      return out + "]";
    };
    const Json labels = {printed(map_.x_label), printed(map_.y_label)};
    svg_ +=
        fmt::format("<metadata>{{\"inside\":[{},{},{},{}],\"labels\":{},\"x\":{},\"y\":{},\"values\":{}}}</metadata>",
                    kLeft, kTop, kInner, kTall, escaped(labels.dump(-1, ' ', false, Json::error_handler_t::replace)),
                    list(map_.x), list(map_.y), list(map_.values));
  }

  const Heatmap& map_;
  const double w_, h_;
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
