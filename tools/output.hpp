// What the verbs share: the common options, where files go, provenance, messages.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/csv.hpp"
#include "common/monitor.hpp"

namespace ukemi::tools {

using Json = nlohmann::ordered_json;

/// Exit codes of the program.
enum Exit : int { kDone = 0, kNumbers = 1, kBadInput = 2, kInterrupted = 130 };

struct CommonOptions {
  std::string folder;  ///< -o
  int threads = 0;
  unsigned long seed = 1;
  enum class Report { kWrite, kSkip } report = Report::kWrite;
  enum class Stdout { kText, kJson, kSilent } out = Stdout::kText;
  enum class Messages { kShow, kQuiet } messages = Messages::kShow;
};

inline constexpr double kDegrees = 57.29577951308232;  ///< in a radian

/// The command line as given, for provenance.
void set_command_line(int argc, char** argv);

/// One verb's run: collects files, warnings and the summary; writes all files at the end, each whole or not at all.
class Run {
 public:
  Run(std::string verb, const CommonOptions& options);

  const CommonOptions& options() const { return options_; }
  /// An input whose checksum goes into the provenance.
  void input(const std::string& path);
  void add(const std::string& name, std::string content);
  /// To stderr, and into the summary's warnings.
  void warn(const std::string& message);
  void info(const std::string& message) const;  ///< to stderr unless --quiet
  /// A line of the result for a reader, to stdout unless --json.
  void say(const std::string& line) const;
  /// Progress on stderr: a bar with rate and remaining time on a terminal; elsewhere a line every ten seconds.
  void progress(const std::string& what, long done, long total) const;
  /// Shows progress as above, and stops at Ctrl-C. The run must outlive it.
  Monitor monitor(const std::string& what) const;

  /// Key, value pairs: version, command line, checksums, seed, time.
  std::vector<std::pair<std::string, std::string>> provenance() const;
  std::string provenance_text() const;  ///< a line each
  CsvWriter csv() const;                ///< with the provenance in front
  const std::vector<std::string>& warnings() const { return warnings_; }
  double seconds() const;

  /// Adds provenance to the summary, writes summary.json and the other files, prints the JSON with --json. Returns the
  /// exit code: kInterrupted after Ctrl-C, and the summary says so.
  int finish(Json summary, int exit_code);
  const Json& summary() const { return summary_; }

 private:
  std::string verb_;
  CommonOptions options_;
  std::vector<std::pair<std::string, std::string>> inputs_;
  std::map<std::string, std::string> files_;
  std::vector<std::string> warnings_;
  std::chrono::steady_clock::time_point start_;
  mutable std::mutex progress_mutex_;
  mutable double shown_ = 0;  ///< when progress was last shown [s]
  Json summary_;
};

/// A file of the shipped datasets, from any working directory: $UKEMI_DATASETS, beside the program, the source tree, or
/// where it was installed.
std::string dataset(const std::string& relative);

/// A number or null.
Json number(double value);
Json number(const std::optional<double>& value);

}  // namespace ukemi::tools
