#include "tools/program/output.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <optional>

#include "common/error.hpp"
#include "common/text.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/program/terminal.hpp"

namespace ukemi::tools {

namespace {

std::string command_line;

/// Every file that a verb may write besides summary.json; '#' is a number.
std::vector<std::string> result_names(const Outputs& outputs) {
  std::vector<std::string> names = outputs.files;
  names.push_back("report.html");
  for (const std::string& figure : outputs.figures)
    for (const char* format : {".svg", ".pdf", ".png"}) names.push_back(figure + format);
  return names;
}

const std::string kWrote = "wrote ";  ///< keys in the summary's provenance: checksums of the files of its run
std::string written_value(const std::string& checksum) { return "fnv1a-64 " + checksum; }

/// The folder of the results; default of `ukemi bench scenes`: ukemi-out/bench-scenes.
std::string folder_of(const std::string& verb, const CommonOptions& options) {
  if (!options.folder.empty()) return options.folder;
  std::string name = verb;
  std::replace(name.begin(), name.end(), ' ', '-');
  return "ukemi-out/" + name;
}

}  // namespace

void set_command_line(int argc, char** argv) {
  command_line = "ukemi";
  for (int i = 1; i < argc; ++i) command_line += " " + shell_quoted(argv[i]);
}

void set_command_line(std::string text) { command_line = std::move(text); }

Outputs Outputs::with(const std::vector<std::string>& more) const {
  Outputs out = *this;
  out.figures.insert(out.figures.end(), more.begin(), more.end());
  return out;
}

Run::Run(const Outputs& outputs, const CommonOptions& options)
    : verb_(outputs.verb),
      options_(options),
      folder_(folder_of(verb_, options), result_names(outputs)),
      watch_([this](const ReadFile& file) { note(file); }),
      start_time_(std::time(nullptr)),
      start_(std::chrono::steady_clock::now()) {
  options_.folder = folder_.path();
}

void Run::note(const ReadFile& file) {
  folder_.refuse_as_input(file);
  read_.emplace(file.device, file.inode);
  if (checksums_.emplace(file.path, file.checksum).first->second != file.checksum)
    throw InputError({file.path}, "changed while this run read it");
}
void Run::adopt_earlier_files() {
  const auto in_folder = [this](const std::string& name) { return (std::filesystem::path(folder()) / name).string(); };
  std::optional<ReadFile> file;
  const ReadWatch watch([&](const ReadFile& read) { file = read; });  // these are no inputs
  const auto adopted = [&](const std::string& name, const Json& checksum) {
    if (name.find_first_of("/#") != std::string::npos || folder_.owns(name)) return false;
    try {
      (void)read_binary_file(in_folder(name));
    } catch (const InputError&) {
      return false;
    }
    return checksum == written_value(file->checksum) && read_.count({file->device, file->inode}) == 0;
  };
  try {
    const Json summary = Json::parse(read_binary_file(in_folder(kSummaryFile)));
    for (const auto& [key, value] : summary.at("provenance").items())
      if (key.starts_with(kWrote))
        if (const std::string name = key.substr(kWrote.size()); adopted(name, value)) folder_.adopt({name});
  } catch (const InputError&) {       // there is no summary
  } catch (const Json::exception&) {  // it is none of ours
  }
}

void Run::input(const std::string& path) {
  if (std::find(inputs_.begin(), inputs_.end(), path) == inputs_.end()) inputs_.push_back(path);
}
void Run::add(const std::string& name, std::string content) {
  if (!folder_.owns(name)) throw std::logic_error(name + ": not among the files that " + verb_ + " may write");
  files_[name] = std::move(content);
}
void Run::warn(const std::string& message) {
  warnings_.push_back(shown(message));
  if (options_.messages != CommonOptions::Messages::kNone)
    print_message("ukemi " + verb_ + ": warning: " + message, Tone::kWarning);
}
void Run::info(const std::string& message) const {
  if (options_.messages == CommonOptions::Messages::kShow) print_message(message);
}
void Run::say(const std::string& line) const {
  if (options_.out == CommonOptions::Stdout::kText) print_line(line);
}
void Run::progress(const std::string& what, const std::string& unit, long done, long total) const {
  if (options_.messages != CommonOptions::Messages::kShow || total <= 0) return;
  constexpr double kBarPeriod = 0.1, kLinePeriod = 10;  // between two updates [s]
  const std::lock_guard lock(progress_mutex_);
  const bool terminal = isatty(fileno(stderr));
  const double elapsed = seconds(), rate = elapsed > 0 ? double(done) / elapsed : 0;
  if (elapsed - last_progress_ < (terminal ? kBarPeriod : kLinePeriod) && !(terminal && done >= total)) return;
  last_progress_ = elapsed;
  const double remaining = rate > 0 ? double(total - done) / rate : 0;
  const std::string state = fmt::format("{} of {} {}, {:.3g}/s, {:.0f} s left", done, total, unit, rate, remaining);
  if (!terminal) {
    print_message(fmt::format("{}: {}", what, state));
    return;
  }
  const int filled = int(30 * double(std::min(done, total)) / double(total));
  const std::string bar = fmt::format("\r{} [{}{}] {}  ", what, std::string(std::size_t(filled), '#'),
                                      std::string(std::size_t(30 - filled), ' '), state);
  print_message_raw((bar + (done >= total ? "\n" : "")).c_str());
}
Monitor Run::monitor(const std::string& what, const std::string& unit) const {
  catch_interrupts();
  return {[this, what, unit](long done, long total) { progress(what, unit, done, total); }, interrupted};
}
double Run::seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

std::vector<std::pair<std::string, std::string>> Run::provenance() const {
  std::vector<std::pair<std::string, std::string>> p = {
      {"program", "ukemi " UKEMI_VERSION}, {"command", command_line}, {"seed", std::to_string(options_.seed)}};
  for (const std::string& path : inputs_)
    if (const auto read = checksums_.find(path); read != checksums_.end())
      p.emplace_back("checksum " + shown(path), "fnv1a-64 " + read->second);
  p.emplace_back("time", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(start_time_)));
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
  csv.comment("Read with pandas.read_csv(file, comment=\"#\"); with numpy.genfromtxt leave these lines out.");
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
  if (options_.report == CommonOptions::Report::kSkip) files_.erase("report.html");
  for (const auto& [name, content] : files_) provenance_block[kWrote + name] = written_value(checksum(content));
  summary["warnings"] = warnings_;
  summary["time_s"] = seconds();
  summary["provenance"] = provenance_block;
  add(kSummaryFile, "");
  for (const auto& [name, content] : files_) summary["files"].push_back(name);
  // A file name that is not UTF-8 is written with replacement characters, never an error.
  const std::string text = summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  add(kSummaryFile, text);
  adopt_earlier_files();
  folder_.replace(files_);
  info("wrote " + options_.folder + "/");
  if (options_.out == CommonOptions::Stdout::kJson) print_raw(text);
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
