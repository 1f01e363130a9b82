#include "host/program/start_at.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/error.hpp"
#include "host/program/skipped_lines.hpp"

namespace lamplock::program_run {

std::vector<link::ProgramLine> start_at(const std::vector<link::ProgramLine>& lines,
                                        std::size_t first, const settings::Values& values,
                                        const std::string& file,
                                        const std::optional<BoardState>& state) {
  const auto begin = std::find_if(lines.begin(), lines.end(),
                                  [first](const auto& line) { return line.number >= first; });
  if (begin == lines.end())
    throw Error(Exit::bad_input, fmt::format("--from {}", first),
                fmt::format("{} has no line at or after this number", file),
                "give the number of one of its lines");
  if (begin == lines.begin()) return lines;
  SkippedLines skipped(values, file, state);
  std::for_each(lines.begin(), begin, [&](const link::ProgramLine& line) { skipped.pass(line); });
  std::vector<link::ProgramLine> rest(begin, lines.end());
  skipped.require_start(rest);
  std::vector<link::ProgramLine> preamble;
  for (std::string& text : skipped.preamble()) preamble.push_back({begin->number, std::move(text)});
  rest.insert(rest.begin(), preamble.begin(), preamble.end());
  // The probe log that was opened before is open. No probe can have been skipped.
  std::vector<std::string> logs;
  std::for_each(lines.begin(), begin, [&](const link::ProgramLine& line) {
    logs.insert(logs.end(), line.logs.begin(), line.logs.end());
  });
  rest.front().logs.insert(rest.front().logs.begin(), logs.begin(), logs.end());
  return rest;
}

}  // namespace lamplock::program_run
