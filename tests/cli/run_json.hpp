// A command that succeeds and prints JSON. Called by the tests of commands.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {

using Json = nlohmann::json;

/// The command's output with --json; expects that it succeeds.
inline Json run_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const Finished finished = run(arguments);
  EXPECT_EQ(finished.status, 0) << finished.err;
  return Json::parse(finished.out, nullptr, false);
}

}  // namespace lamplock::cli::test
