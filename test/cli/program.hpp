// Runs the real program as a user does, and looks at what it left.
#pragma once

#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "test/folder.hpp"

namespace cli {

using namespace test;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

/// A shipped file.
inline std::string dataset(const std::string& name) { return std::string(UKEMI_DATASETS) + "/" + name; }

inline const std::string kRig = dataset("rigs/paper.toml"), kTable2 = dataset("actuators/table2.toml"),
                         kNominal = dataset("actuators/x8-9_nominal.toml"), kPaper = dataset("scenes/paper.toml"),
                         kTrial1 = dataset("impact/trial_1.csv"), kTrial2 = dataset("impact/trial_2.csv");

/// The eight impact trials.
inline Arguments impact_trials() {
  Arguments out;
  for (int i = 1; i <= 8; ++i) out.push_back(dataset("impact/trial_" + std::to_string(i) + ".csv"));
  return out;
}

inline Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Result {
  int code = -1;
  std::string out, err;  ///< stdout, stderr
};

inline std::string shell_quoted(const std::string& s) {
  std::string out = "'";
  for (const char c : s) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// What the program finds around it, as a shell sets it up.
struct Surroundings {
  std::string limits;    ///< commands before it, as "ulimit -v 400000"
  std::string out, err;  ///< where its streams go instead of being captured, as ">/dev/full", ">&-"
};

/// Seconds after which a run of the program counts as endless: $UKEMI_TEST_TIMEOUT, for builds that are slow.
inline std::string patience() {
  const char* given = std::getenv("UKEMI_TEST_TIMEOUT");
  return given ? given : "60";
}

/// `ukemi ARGUMENTS...` started in the folder `directory`. What it prints goes to files outside of it. The code of a
/// run that a signal ended is 128 and the signal, as in a shell.
inline Result run(const Arguments& arguments, const std::string& directory, const Surroundings& around = {}) {
  const Folder capture;
  std::string command = "cd " + shell_quoted(directory) + " && ";
  if (!around.limits.empty()) command += around.limits + " && ";
  command += "exec timeout " + patience() + " " + shell_quoted(UKEMI_PROGRAM);
  for (const std::string& a : arguments) command += " " + shell_quoted(a);
  command += " " + (around.out.empty() ? ">" + capture.write("out", "") : around.out);
  command += " 2" + (around.err.empty() ? ">" + capture.write("err", "") : around.err) + " </dev/null";
  const int status = std::system(command.c_str());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const auto captured = [&](const char* name) { return fs::exists(capture.at(name)) ? read(capture.at(name)) : ""; };
  return {code, captured("out"), captured("err")};
}

struct Interrupted : Result {
  double seconds = 0;  ///< from the start to the end, the wait included
};
/// The same, with Ctrl-C after so many seconds.
inline Interrupted interrupted_after(double seconds, const Arguments& arguments, const std::string& directory) {
  const Folder capture;
  // In the foreground: else timeout signals its whole group too, and the second signal of the two ends the program.
  std::string command = "cd " + shell_quoted(directory) +
                        " && exec timeout --foreground --preserve-status -s INT -k 30 " + std::to_string(seconds) +
                        " " + shell_quoted(UKEMI_PROGRAM);
  for (const std::string& a : arguments) command += " " + shell_quoted(a);
  command += " >" + capture.at("out") + " 2>" + capture.at("err") + " </dev/null";
  const auto start = std::chrono::steady_clock::now();
  const int status = std::system(command.c_str());
  Interrupted out;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  out.out = read(capture.at("out")), out.err = read(capture.at("err"));
  return out;
}

/// Runs the program in `folder`; it must succeed.
inline Result done(const Folder& folder, const Arguments& arguments) {
  const Result r = run(arguments, folder.at(""));
  INFO(r.err);
  REQUIRE(r.code == 0);
  return r;
}

/// What the last run left in a folder for scripts to read.
inline Json summary(const Folder& f, const std::string& folder = "out") {
  return Json::parse(read(f.at(folder + "/summary.json")));
}

/// Whether a summary warns of something, by a part of its words.
inline bool warned(const Json& summary, const std::string& text) {
  for (const Json& w : summary["warnings"])
    if (w.get<std::string>().find(text) != std::string::npos) return true;
  return false;
}

}  // namespace cli
