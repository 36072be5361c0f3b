#include "tools/output.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "common/error.hpp"
#include "common/files.hpp"
#include "tools/interrupt.hpp"

namespace ukemi::tools {

namespace {
std::string command_line;
}

void set_command_line(int argc, char** argv) {
  command_line = "ukemi";
  for (int i = 1; i < argc; ++i) command_line += std::string(" ") + argv[i];
}

Run::Run(std::string verb, const CommonOptions& options)
    : verb_(std::move(verb)), options_(options), start_(std::chrono::steady_clock::now()) {
  if (options_.folder.empty()) options_.folder = "ukemi-out/" + verb_;
  require_writable_folder(options_.folder);
}

void Run::input(const std::string& path) {
  for (const auto& [known, sum] : inputs_)
    if (known == path) return;
  inputs_.emplace_back(path, checksum(path));
}
void Run::add(const std::string& name, std::string content) { files_[name] = std::move(content); }
void Run::warn(const std::string& message) {
  warnings_.push_back(message);
  fmt::print(stderr, "ukemi {}: warning: {}\n", verb_, message);
}
void Run::info(const std::string& message) const {
  if (options_.messages == CommonOptions::Messages::kShow) fmt::print(stderr, "{}\n", message);
}
void Run::say(const std::string& line) const {
  if (options_.out == CommonOptions::Stdout::kText) fmt::print("{}\n", line);
}
void Run::progress(const std::string& what, long done, long total) const {
  if (options_.messages == CommonOptions::Messages::kQuiet || total <= 0) return;
  constexpr double kBar = 0.1, kLine = 10;  // between two sights of it [s]
  const std::lock_guard lock(progress_mutex_);
  const bool terminal = isatty(fileno(stderr));
  const double elapsed = seconds(), rate = elapsed > 0 ? double(done) / elapsed : 0;
  if (elapsed - shown_ < (terminal ? kBar : kLine) && !(terminal && done >= total)) return;
  shown_ = elapsed;
  const double left = rate > 0 ? double(total - done) / rate : 0;
  if (!terminal) {
    fmt::print(stderr, "{}: {} of {}, {:.3g}/s, {:.0f} s left\n", what, done, total, rate, left);
    return;
  }
  const int filled = int(30 * double(std::min(done, total)) / double(total));
  fmt::print(stderr, "\r{} [{}{}] {:.3g}/s, {:.0f} s left  ", what, std::string(std::size_t(filled), '#'),
             std::string(std::size_t(30 - filled), ' '), rate, left);
  if (done >= total) fmt::print(stderr, "\n");
  std::fflush(stderr);
}
Monitor Run::monitor(const std::string& what) const {
  return {[this, what](long done, long total) { progress(what, done, total); }, interrupted};
}
double Run::seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

std::vector<std::pair<std::string, std::string>> Run::provenance() const {
  std::vector<std::pair<std::string, std::string>> p = {
      {"program", "ukemi " UKEMI_VERSION}, {"command", command_line}, {"seed", std::to_string(options_.seed)}};
  for (const auto& [path, sum] : inputs_) p.emplace_back("checksum " + path, "fnv1a-64 " + sum);
  p.emplace_back("time", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))));
  return p;
}
std::string Run::provenance_text() const {
  std::string text;
  for (const auto& [key, value] : provenance()) text += key + ": " + value + "\n";
  return text;
}
CsvWriter Run::csv() const {
  CsvWriter csv;
  csv.comment(provenance_text());
  return csv;
}

int Run::finish(Json summary, int exit_code) {
  if (interrupted()) {
    warn("interrupted: these results are of what was finished until then");
    summary["interrupted"] = true;
    exit_code = kInterrupted;
  }
  Json provenance_block;
  for (const auto& [key, value] : provenance()) provenance_block[key] = value;
  summary["warnings"] = warnings_;
  summary["time_s"] = seconds();
  summary["provenance"] = provenance_block;
  summary_ = std::move(summary);
  // A file name may be no UTF-8: it is shown with replacement characters, never an error.
  const std::string text = summary_.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  add("summary.json", text);
  for (const auto& [name, content] : files_) {
    if (name == "report.html" && options_.report == CommonOptions::Report::kSkip) continue;
    write_file(options_.folder + "/" + name, content);
  }
  info("wrote " + options_.folder + "/");
  if (options_.out == CommonOptions::Stdout::kJson) fmt::print("{}", text);
  return exit_code;
}

std::string dataset(const std::string& relative) {
  namespace fs = std::filesystem;
  std::vector<fs::path> roots;
  if (const char* given = std::getenv("UKEMI_DATASETS")) roots.emplace_back(given);
  std::error_code ec;
  const fs::path program = fs::read_symlink("/proc/self/exe", ec);
  if (!ec) roots.push_back(program.parent_path().parent_path() / "share/ukemi/datasets");
  roots.emplace_back(UKEMI_SOURCE_DATASETS);
  for (const fs::path& root : roots)
    if (fs::exists(root / relative, ec)) return (root / relative).string();
  throw InputError("the shipped data are not found: " + relative +
                   ": set UKEMI_DATASETS to the project's datasets folder");
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

}  // namespace ukemi::tools
