// The program refuses: exit code 2, one line on stderr, nothing written.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>

#include "test/cli/program.hpp"

namespace cli {

/// Runs the program in `folder` with results meant for folder/out, and checks that it refuses as promised, naming
/// `texts`.
inline void check_refused(const Folder& folder, const Arguments& arguments, const std::vector<std::string>& texts) {
  const auto before = folder.content();
  const Result r = run(arguments, folder.at(""));
  INFO("stderr: " << r.err);
  CHECK(r.code == 2);
  CHECK(r.out == "");
  CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
  CHECK((!r.err.empty() && r.err.back() == '\n'));
  for (const std::string& t : texts) CHECK_THAT(r.err, Catch::Matchers::Contains(t));
  const bool nothing_written = folder.content() == before;  // no output folder, no file, none changed
  CHECK(nothing_written);
}

inline const Arguments kOut = {"-o", "out"};

}  // namespace cli
