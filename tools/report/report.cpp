#include "tools/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "common/text.hpp"

namespace ukemi::tools {

namespace {

std::string escape(const std::string& s) {
  static const std::map<char, std::string> marks = {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : shown(s)) out += marks.contains(c) ? marks.at(c) : std::string(1, c);
  return out;
}

/// A round step that gives about `count` ticks over a range.
double tick_step(double range, int count) {
  const double raw = range / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double m : {1.0, 2.0, 5.0})
    if (m * power >= raw) return m * power;
  return 10 * power;
}

constexpr std::array<const char*, 6> kColours = {"#1f5fa8", "#c2452d", "#3c8a3f", "#8a5aa8", "#b8860b", "#444444"};
constexpr std::array<const char*, 3> kDashes = {"none", "7 3", "2 3"};  ///< for those beyond the colours

}  // namespace

Report::Report(const std::string& title) {
  html_ = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escape(title) +
          "</title><style>body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#222}"
          "table{border-collapse:collapse;margin:1em 0}td,th{border-bottom:1px solid #ccc;padding:.25em "
          ".8em;text-align:right}"
          "th:first-child,td:first-child{text-align:left}svg{max-width:100%;height:auto}</style></head><body><h1>" +
          escape(title) + "</h1>\n";
}
std::string Report::html(const std::vector<std::pair<std::string, std::string>>& provenance) {
  heading("Provenance");
  std::vector<std::string> lines;
  for (const auto& [key, value] : provenance) lines.push_back(key + ": " + value);
  list(lines);
  return html_ + "</body></html>\n";
}
void Report::heading(const std::string& text) { html_ += "<h2>" + escape(text) + "</h2>\n"; }
void Report::paragraph(const std::string& text) { html_ += "<p>" + escape(text) + "</p>\n"; }
void Report::list(const std::vector<std::string>& items) {
  if (items.empty()) return;
  html_ += "<ul>";
  for (const std::string& i : items) html_ += "<li>" + escape(i) + "</li>";
  html_ += "</ul>\n";
}
void Report::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  html_ += "<table><tr>";
  for (const std::string& h : header) html_ += "<th>" + escape(h) + "</th>";
  html_ += "</tr>\n";
  for (const auto& row : rows) {
    html_ += "<tr>";
    for (const std::string& cell : row) html_ += "<td>" + escape(cell) + "</td>";
    html_ += "</tr>\n";
  }
  html_ += "</table>\n";
}

std::string Report::plot(const std::string& x_label, const std::string& y_label, std::vector<Series> series,
                         Axes axes) {
  const bool log = axes == Axes::kLogarithmic;
  if (log)
    for (Series& s : series)
      for (std::vector<double>* v : {&s.x, &s.y})
        for (double& x : *v) x = x > 0 ? std::log10(x) : std::numeric_limits<double>::quiet_NaN();
  const auto label = [log](double v) {
    return log ? fmt::format("{:g}", std::pow(10.0, v)) : fmt::format("{:.4g}", v);
  };
  const auto step_of = [log](double range, int count) {
    const double step = tick_step(range, count);
    return log ? std::max(1.0, std::ceil(step)) : step;
  };
  constexpr double kWidth = 820, kHeight = 340, kLeft = 70, kBottom = 45, kTop = 25;
  // A few names stand above the plot; more of them in a column beside it.
  const bool column = series.size() > 5;
  const double right = column ? 130 : 15;
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
  for (const Series& s : series)
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.y[i]) || !std::isfinite(s.x[i])) continue;
      x0 = std::min(x0, s.x[i]), x1 = std::max(x1, s.x[i]), y0 = std::min(y0, s.y[i]), y1 = std::max(y1, s.y[i]);
    }
  if (!(x1 > x0)) return {};
  if (!(y1 > y0)) y0 -= 1, y1 += 1;
  const auto px = [&](double x) { return kLeft + (x - x0) / (x1 - x0) * (kWidth - kLeft - right); };
  const auto py = [&](double y) { return kHeight - kBottom - (y - y0) / (y1 - y0) * (kHeight - kBottom - kTop); };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\" "
      "aria-label=\"{} against {}\" font-size=\"12\" font-family=\"sans-serif\" style=\"background:#fff\">",
      kWidth, kHeight, kWidth, escape(y_label), escape(x_label));
  for (double step = step_of(y1 - y0, 5), v = std::ceil(y0 / step) * step; v <= y1; v += step)
    svg += fmt::format(
        "<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>",
        kLeft, kWidth - right, py(v), py(v), kLeft - 6, py(v) + 4, label(std::abs(v) < 1e-12 * (y1 - y0) ? 0 : v));
  for (double step = step_of(x1 - x0, 8), v = std::ceil(x0 / step) * step; v <= x1; v += step)
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", px(v), kHeight - kBottom + 18,
                       label(std::abs(v) < 1e-12 * (x1 - x0) ? 0 : v));
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text x=\"5\" y=\"14\">{}</text>",
                     kWidth / 2, kHeight - 8, escape(x_label), escape(y_label));
  for (std::size_t n = 0; n < series.size(); ++n) {
    const Series& s = series[n];
    const char* colour = kColours[n % kColours.size()];
    const std::string pen = fmt::format("stroke=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"{}\"", colour,
                                        column && n == 0 ? 2.6 : 1.3, kDashes[n / kColours.size() % kDashes.size()]);
    svg += fmt::format("<polyline fill=\"none\" {} points=\"", pen);
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (std::isfinite(s.x[i]) && std::isfinite(s.y[i])) svg += fmt::format("{:.1f},{:.1f} ", px(s.x[i]), py(s.y[i]));
    svg += "\"/>";
    const double x = column ? kWidth - right + 35 : 180 + (series.size() > 3 ? 110 : 180) * double(n),
                 y = column ? kTop + 18 * double(n) + 8 : 14;
    if (column)
      svg += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{}\" y2=\"{}\" {}/>", x - 25, x - 5, y - 4, y - 4, pen);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>", x, y, colour, escape(s.name));
  }
  svg += "</svg>";
  html_ += svg + "\n";
  return svg;
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

std::string Report::heatmap(const Heatmap& m) {
  std::vector<double> sorted;
  for (const double v : m.values)
    if (std::isfinite(v)) sorted.push_back(v);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  const double low = sorted.front(), high = std::max(sorted[sorted.size() * 9 / 10], low * (1 + 1e-9));
  constexpr double kWidth = 640, kHeight = 420, kLeft = 70, kBottom = 45, kTop = 25, kRight = 90;
  const std::size_t nx = m.x.size(), ny = m.y.size();
  const double w = (kWidth - kLeft - kRight) / double(nx), h = (kHeight - kBottom - kTop) / double(ny);
  constexpr int kSteps = 48;  // equal neighbours are drawn as one
  const auto shade = [&](std::size_t i, std::size_t j) {
    const double v = m.values[j * nx + i];
    return std::isfinite(v) ? int(std::clamp((v - low) / (high - low), 0.0, 1.0) * kSteps) : -1;
  };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\" "
      "aria-label=\"{} against {}\" font-size=\"12\" "
      "font-family=\"sans-serif\" shape-rendering=\"crispEdges\">",
      kWidth, kHeight, kWidth, escape(m.y_label), escape(m.x_label));
  const auto box = [&](double x, double y, double width, double height, int step) {
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x, y, width,
                       height, colour(double(step) / kSteps));
  };
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx;) {
      const int step = shade(i, j);
      const std::size_t begin = i;
      while (i < nx && shade(i, j) == step) ++i;
      if (step >= 0)
        box(kLeft + w * double(begin), kHeight - kBottom - h * double(j + 1), w * double(i - begin), h + 0.3, step);
    }
  const auto text = [&](double x, double y, const char* anchor, const std::string& s) {
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor, escape(s));
  };
  for (int q = 0; q <= 4; ++q) {
    const double s = q / 4.0;
    text(kLeft + s * (kWidth - kLeft - kRight), kHeight - kBottom + 18, "middle",
         fmt::format("{:.3g}", m.x.front() + s * (m.x.back() - m.x.front())));
    text(kLeft - 6, kHeight - kBottom - s * (kHeight - kBottom - kTop) + 4, "end",
         fmt::format("{:.3g}", m.y.front() + s * (m.y.back() - m.y.front())));
    const double y = kHeight - kBottom - s * (kHeight - kBottom - kTop);
    text(kWidth - kRight + 40, y + 4, "start", fmt::format("{:.4g}", low + s * (high - low)));
  }
  for (int q = 0; q < kSteps; ++q)
    box(kWidth - kRight + 15, kTop + (kHeight - kBottom - kTop) * (1 - double(q + 1) / kSteps), 18,
        (kHeight - kBottom - kTop) / kSteps + 0.3, q);
  text((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", m.x_label);
  text(5, 14, "start", m.y_label);
  svg += "</svg>";
  html_ += svg + "\n";
  return svg;
}

Json tell(const Table& table, Report& report, Run& run, const std::string& csv, const std::string& comment) {
  say(table, run);
  report.table(table);
  if (!csv.empty()) run.add(csv, table.csv(run, comment));
  return table.objects();
}

}  // namespace ukemi::tools
