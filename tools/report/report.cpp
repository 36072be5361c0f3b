#include "tools/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "tools/report/page/page.hpp"

namespace ukemi::tools {

namespace {

/// Where a figure will stand: a character that no text shown has.
std::string placeholder(std::size_t figure) { return fmt::format("\x01{}\x02", figure); }

constexpr const char* kEnd = "</div>\n";

/// Places of the panels for the cursor that follows the animation.
std::string places_json(const Drawing& d) {
  Json out = Json::array();
  for (const Place& p : d.places)
    out.push_back(
        {{"left", p.left}, {"right", p.right}, {"top", p.top}, {"bottom", p.bottom}, {"x0", p.x[0]}, {"x1", p.x[1]}});
  return out.dump();
}

/// The class and the data of a figure's element.
std::string opening(const Figure& f, const Drawing& d) {
  std::string out = "<figure id=\"figure-" + escaped(f.name) + "\"";
  if (f.width == Figure::Width::kWhole) out += " class=\"whole\"";
  if (f.cursor == Figure::Cursor::kTime) out += " data-places=\"" + escaped(places_json(d)) + "\"";
  return out + ">";
}

std::string element(const Figure& f, const Drawing& d) {
  std::string svg = d.svg;
  std::string described = f.caption.empty() ? f.name : f.caption;
  for (const Panel& p : f.panels)
    if (f.panels.size() == 1) described = p.y_label + " against " + p.x_label + ". " + f.caption;
  svg.replace(0, 4, "<svg role=\"img\" aria-label=\"" + escaped(described) + "\"");
  std::string out = opening(f, d) + "<div class=\"drawing\">" + svg + "</div>";
  if (!f.caption.empty()) out += "<figcaption>" + escaped(f.caption) + "</figcaption>";
  return out + "</figure>\n";
}

/// Escaped line by line.
std::string escaped_lines(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out += escaped(line) + "\n";
  return out;
}

/// An SVG that stands alone, with where it comes from.
std::string alone(std::string svg, const std::string& provenance) {
  const std::size_t root = svg.find("<svg");
  if (root == std::string::npos) return svg;
  svg.insert(svg.find('>', root) + 1, "\n<metadata>" + escaped_lines(provenance) + "</metadata>");
  return svg.insert(root + 4, " style=\"color:black;background:white\"");
}

}  // namespace

Report::Report(const std::string& title) : title_(title) {}

std::string& Report::body() {
  if (in_figures_) html_ += kEnd;
  in_figures_ = false;
  return html_;
}
void Report::heading(const std::string& text) { body() += "<h2>" + escaped(text) + "</h2>\n"; }
void Report::paragraph(const std::string& text) { body() += "<p>" + escaped(text) + "</p>\n"; }
void Report::list(const std::vector<std::string>& items) {
  if (items.empty()) return;
  body() += "<ul>";
  for (const std::string& i : items) html_ += "<li>" + escaped(i) + "</li>";
  html_ += "</ul>\n";
}
void Report::distrust(const std::vector<std::string>& sentences) {
  body() += "<section class=\"doubt\"><h2>What to distrust</h2>\n";
  if (sentences.empty()) html_ += "<p>No check of this run found a fault.</p>\n";
  list(sentences);
  html_ += "</section>\n";
}
void Report::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
  body() += "<div class=\"table\"><table><thead><tr>";
  for (const std::string& h : header) html_ += "<th scope=\"col\">" + escaped(h) + "</th>";
  html_ += "</tr></thead>\n";
  for (const auto& row : rows) {
    html_ += "<tr>";
    for (const std::string& cell : row) html_ += "<td>" + escaped(cell) + "</td>";
    html_ += "</tr>\n";
  }
  html_ += "</table></div>\n";
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
  for (Panel& p : f.panels)
    for (Series& s : p.series)
      if (s.low.empty()) s = thinned(s);
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

std::map<std::string, std::string> Report::files(const Run& run, std::vector<std::string> formats) const {
  const bool page_wanted = run.options().report == CommonOptions::Report::kWrite;
  for (const std::string& f : run.options().figures)
    if (std::find(formats.begin(), formats.end(), f) == formats.end()) formats.push_back(f);
  if (!page_wanted && formats.empty()) return {};
  std::string why;
  const std::vector<Drawing> drawings = draw(figures_, formats, why);
  std::map<std::string, std::string> out;
  std::string text = html_ + (in_figures_ ? kEnd : "");
  for (std::size_t i = 0; i < figures_.size(); ++i) {
    const std::string mark = placeholder(i);
    text.replace(text.find(mark), mark.size(), drawings.empty() ? "" : element(figures_[i], drawings[i]));
  }
  for (const Drawing& d : drawings)
    for (const auto& [name, content] : d.files)
      out[name] = name.ends_with(".svg") ? alone(content, run.provenance_text()) : content;
  if (!why.empty()) text += "<p>The figures are left out: " + escaped(why) + ".</p>\n";
  text += "<section class=\"provenance\"><h2>Provenance</h2>\n<ul>";
  for (const auto& [key, value] : run.provenance()) text += "<li>" + escaped(key + ": " + value) + "</li>";
  text += "</ul></section>\n";
  if (page_wanted) out["report.html"] = page(title_, text);
  return out;
}
void Report::write(Run& run, const std::vector<std::string>& formats) const {
  for (auto& [name, content] : files(run, formats)) run.add(name, content);
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
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"map\" viewBox=\"0 0 {} {}\" width=\"{}\" role=\"img\" "
      "aria-label=\"{} against {}\" "
      "font-size=\"12\" "
      "font-family=\"sans-serif\" fill=\"currentColor\" shape-rendering=\"crispEdges\">",
      kWidth, kHeight, kWidth, escaped(m.y_label), escaped(m.x_label));
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
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor, escaped(s));
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
  body() += svg + "\n";
  return svg;
}

Json tell(const Table& table, Report& report, Run& run, const std::string& csv, const std::string& comment) {
  say(table, run);
  report.table(table);
  if (!csv.empty()) run.add(csv, table.csv(run, comment));
  return table.objects();
}

}  // namespace ukemi::tools
