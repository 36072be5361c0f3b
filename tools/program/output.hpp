// Output that all verbs share: common options, result files, provenance, messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>
#include <map>
#include <mutex>
#include <set>
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
  bool figures_wanted() const { return report == Report::kWrite || !figures.empty(); }
};

/// The command line as a shell takes it, for provenance.
void set_command_line(int argc, char** argv);
/// The command line of another front end, as it is given.
void set_command_line(std::string text);

/// The files that a verb may write.
struct Outputs {
  std::string verb;                       ///< "trade"; "bench scenes"
  std::vector<std::string> files;         ///< besides summary.json and report.html; '#' is a number
  std::vector<std::string> figures = {};  ///< of its report, which --figures writes as files of their own

  /// With further figures.
  Outputs with(const std::vector<std::string>& more) const;
};

/// One verb's run: collects files, warnings and the summary; at the end they replace the results of an earlier run in
/// the folder, also of another verb. A file that this run reads is neither overwritten nor removed.
class Run {
 public:
  Run(const Outputs& outputs, const CommonOptions& options);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  const CommonOptions& options() const { return options_; }
  const std::string& folder() const { return folder_.path(); }  ///< of the results
  /// Notes a file that is or will be read: its checksum goes into the provenance.
  void input(const std::string& path);
  /// Adds a result file, under one of the names of the verb's Outputs.
  void add(const std::string& name, std::string content);
  /// Removes the earlier results before the run finishes: for a run that consists of several runs.
  void withdraw_results() { adopt_earlier_files(), folder_.withdraw(); }
  /// Adds to the summary's warnings and prints to stderr, unless Messages::kNone.
  void warn(const std::string& message);
  void info(const std::string& message) const;  ///< to stderr unless --quiet
  /// Prints a line of the result to stdout, unless --json.
  void say(const std::string& line) const;
  /// Progress on stderr: a bar with rate and remaining time on a terminal; elsewhere a line every ten seconds.
  void progress(const std::string& what, const std::string& unit, long done, long total) const;
  /// A monitor that shows progress in `unit` (plural) as above and stops at Ctrl-C, which from now on is a request. The
  /// run must outlive it.
  Monitor monitor(const std::string& what, const std::string& unit) const;

  /// Key-value pairs, safe to print: version, command line, checksums, seed, time of the start.
  std::vector<std::pair<std::string, std::string>> provenance() const;
  std::string provenance_text() const;  ///< a line each
  CsvWriter csv() const;                ///< starts with the provenance as comments
  const std::vector<std::string>& warnings() const { return warnings_; }
  double seconds() const;

  /// Adds provenance and file names to the summary, replaces the result files, prints the JSON with --json.
  /// Returns the exit code: kInterrupted after Ctrl-C, and the summary says so.
  int finish(Json summary, int exit_code);

 private:
  void note(const ReadFile& file);
  /// Lets the folder give up what an earlier run of another verb wrote, where it still is as that run's summary says.
  void adopt_earlier_files();

  std::string verb_;
  CommonOptions options_;
  ResultFolder folder_;
  ReadWatch watch_;
  std::vector<std::string> inputs_;
  std::map<std::string, std::string> checksums_;  ///< of every file that was read
  std::set<std::pair<dev_t, ino_t>> read_;        ///< the same files
  std::map<std::string, std::string> files_;
  std::vector<std::string> warnings_;
  std::time_t start_time_;  ///< in the provenance of every file
  std::chrono::steady_clock::time_point start_;
  mutable std::mutex progress_mutex_;
  mutable double last_progress_ = 0;  ///< when progress was last shown [s]
};

/// A file of the shipped datasets, from any working directory: $UKEMI_DATASETS, beside the program, the source tree, or
/// where it was installed.
std::string dataset(const std::string& relative);

/// The number, or null where it is not finite or absent.
Json number(double value);
Json number(const std::optional<double>& value);

}  // namespace ukemi::tools
