// What the verbs share: the common options, where files go, provenance, messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/monitor.hpp"
#include "common/result_folder.hpp"
#include "tools/program/json.hpp"

namespace ukemi::tools {

/// Exit codes of the program.
enum Exit : int { kDone = 0, kNumbers = 1, kBadInput = 2, kInterrupted = 130 };

struct CommonOptions {
  std::string folder;  ///< -o
  int threads = 0;
  std::uint64_t seed = 1;
  enum class Report { kWrite, kSkip } report = Report::kWrite;
  std::vector<std::string> figures;  ///< of svg, pdf, png: the report's figures as files of their own
  enum class Stdout { kText, kJson, kSilent } out = Stdout::kText;
  enum class Lines { kAnswer, kAll } lines = Lines::kAnswer;                ///< of text on stdout
  enum class Messages { kShow, kQuiet, kNone } messages = Messages::kShow;  ///< kNone: not even warnings
};

/// The command line as a shell takes it, for provenance.
void set_command_line(int argc, char** argv);
/// The command line of another front end, as it is given.
void set_command_line(std::string text);

/// What a verb writes.
struct Outputs {
  std::string verb;                       ///< "trade"; "bench scenes"
  std::vector<std::string> files;         ///< besides summary.json and report.html; '#' stands for a number
  std::vector<std::string> figures = {};  ///< of its report, which --figures writes as files of their own

  /// With the figures of another picture.
  Outputs with(const std::vector<std::string>& more) const;
};

/// One verb's run: collects files, warnings and the summary, and at the end exchanges what an earlier run left for
/// them. Nothing is written over that this run reads.
class Run {
 public:
  Run(const Outputs& outputs, const CommonOptions& options);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  const CommonOptions& options() const { return options_; }
  const std::string& folder() const { return folder_.path(); }  ///< of the results
  /// A file that is or will be read: the checksum of what was read goes into the provenance.
  void input(const std::string& path);
  /// A file of the results, under one of the names of the verb's Outputs.
  void add(const std::string& name, std::string content);
  /// For a run whose parts are runs of their own: until it finishes, its folder has no summary.
  void withdraw_summary() const { folder_.withdraw_summary(); }
  /// Into the summary's warnings, and to stderr but with Messages::kNone.
  void warn(const std::string& message);
  void info(const std::string& message) const;  ///< to stderr unless --quiet
  /// A line of the result for a reader, to stdout unless --json.
  void say(const std::string& line) const;
  /// Progress on stderr: a bar with rate and remaining time on a terminal; elsewhere a line every ten seconds.
  void progress(const std::string& what, const std::string& unit, long done, long total) const;
  /// Shows progress of `unit`, in the plural, as above, and stops at Ctrl-C, which from now on is a request. The run
  /// must outlive it.
  Monitor monitor(const std::string& what, const std::string& unit) const;

  /// Key, value pairs, safe to show: version, command line, checksums, seed, time of the start.
  std::vector<std::pair<std::string, std::string>> provenance() const;
  std::string provenance_text() const;  ///< a line each
  CsvWriter csv() const;                ///< with the provenance in front
  const std::vector<std::string>& warnings() const { return warnings_; }
  double seconds() const;

  /// Adds provenance and the names of the files to the summary, exchanges the files, prints the JSON with --json.
  /// Returns the exit code: kInterrupted after Ctrl-C, and the summary says so.
  int finish(Json summary, int exit_code);

 private:
  void note(const ReadFile& file);

  std::string verb_;
  CommonOptions options_;
  ResultFolder folder_;
  ReadWatch watch_;
  std::vector<std::string> inputs_;
  std::map<std::string, std::string> checksums_;  ///< of every file that was read
  std::map<std::string, std::string> files_;
  std::vector<std::string> warnings_;
  std::time_t started_;  ///< the time of the provenance: one for all files
  std::chrono::steady_clock::time_point start_;
  mutable std::mutex progress_mutex_;
  mutable double shown_ = 0;  ///< when progress was last shown [s]
};

/// A file of the shipped datasets, from any working directory: $UKEMI_DATASETS, beside the program, the source tree, or
/// where it was installed.
std::string dataset(const std::string& relative);

/// A number or null.
Json number(double value);
Json number(const std::optional<double>& value);

}  // namespace ukemi::tools
