#include "host/run/feed_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/error.hpp"
#include "host/model/input.hpp"
#include "host/model/read_points.hpp"
#include "host/program/board_lines.hpp"
#include "host/program/file_line.hpp"
#include "host/program/program_path.hpp"
#include "host/program/program_run.hpp"
#include "host/run/placed_axes.hpp"
#include "host/run/sent_file.hpp"
#include "host/text.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::run {
namespace {

using feed_optimiser::Block;
using feed_optimiser::FeedProgram;
using feed_optimiser::Laser;
using feed_optimiser::Part;
using geometry::Point;
using program_run::PathLaser;
using program_run::PathMove;
using program_run::PathStep;

Error no_block(const std::string& file) {
  return {Exit::bad_input, file, "has no block to optimise: no two places differ",
          "give it a line, an arc or two points"};
}

FeedProgram polyline(const std::string& file) {
  const geometry::PointCloud points = model::read_point_list(file);
  FeedProgram program;
  if (!points.empty()) program.start = points.front();
  program.parts.emplace_back();
  for (std::size_t i = 1; i < points.size(); ++i) {
    Block block = feed_optimiser::straight_block(points[i - 1], points[i]);
    block.line = i + 1;
    program.parts[0].blocks.push_back(block);
  }
  return program;
}

Laser laser_of(const PathMove& move) {
  if (move.laser == PathLaser::none) return {};
  constexpr std::array codes{"", "M5", "M3", "M4"};
  return {codes[static_cast<std::size_t>(move.laser)], move.laser == PathLaser::off ? 0 : move.s};
}

std::vector<Point> points_of(const PathMove& move, const std::string& file) {
  std::vector<Point> points;
  for (const PerAxis<double>& at : move.vertices) {
    points.push_back({at[0], at[1], at[2]});
    for (std::size_t a = feed_optimiser::axes; a < at.size(); ++a)
      if (at[a] != move.vertices.front()[a])
        throw Error(Exit::bad_input, fmt::format("{}:{}", file, move.line),
                    "moves an axis other than X, Y and Z", "remove its word (A) from the line");
  }
  return points;
}

/// A line or an arc; other curves are their chords.
std::vector<Block> blocks_of(const PathMove& move, const std::string& file,
                             std::vector<std::string>& remarks) {
  const std::vector<Point> points = points_of(move, file);
  std::vector<Block> blocks;
  if (points.size() > 2)
    if (std::optional<Block> arc = feed_optimiser::arc_block(points)) blocks.push_back(*arc);
  if (blocks.empty()) {
    for (std::size_t i = 1; i < points.size(); ++i)
      blocks.push_back(feed_optimiser::straight_block(points[i - 1], points[i]));
    if (points.size() > 2)
      remarks.push_back(
          fmt::format("{}:{}: the curve is no arc: {} straight blocks with a stop "
                      "between them",
                      file, move.line, blocks.size()));
  }
  for (Block& block : blocks) {
    block.line = move.line;
    block.rapid = move.rapid;
    if (!move.rapid && move.feed_mm_s > 0) block.feed_mm_s = move.feed_mm_s;
  }
  return blocks;
}

/// The word of a line whose effect depends on what the board has stored: offsets, places, shifts.
/// Empty: none.
std::string stored_word(std::string_view line) {
  // Tenths of the numbers: G10, G28 and G30 with their .1, G53, G54.1, G55 to G59.3, G92 to G92.3.
  constexpr std::array codes{100, 280, 281, 300, 301, 530, 541, 550, 560, 570,
                             580, 590, 591, 592, 593, 920, 921, 922, 923};
  const program_run::FileLine read(line);
  program::WordReader reader(read.text());
  program::Word word;
  while (!reader.next(word) && word.letter != 0) {
    const auto tenths = program::scaled(word, 1, 1);
    if (word.letter == 'G' && std::find(codes.begin(), codes.end(), tenths) != codes.end())
      return fmt::format("G{:g}", static_cast<double>(tenths) / 10);
  }
  return "";
}

/// The new program has the places of this one in the coordinates of G54, with no stored values.
void require_own_places(std::string_view text, const std::string& file) {
  text = without_byte_order_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    const bool is_command = program_run::is_board_line(trimmed(line));
    const std::string word = is_command ? std::string(trimmed(line)) : stored_word(line);
    if (word.empty()) continue;
    throw Error(Exit::bad_input, fmt::format("{}:{}", file, number),
                is_command
                    ? fmt::format("{} is a command for the board, not a part of the program", word)
                    : fmt::format("the effect of {} depends on what the board has stored", word),
                is_command ? "send it before the program, and remove it here"
                           : "remove it: use the coordinates of G54");
  }
}

/// Without a machine its work space is not known.
void require_runnable(const std::string& text, const std::string& file, job::Profile profile,
                      bool has_machine) {
  if (!has_machine) job::state_setting(profile, settings::Id::soft_limits, 0, file);
  const program_run::ProgramRun run = program_run::run_program(text, profile.settings, 1);
  if (run.problems.empty()) return;
  const program_run::Problem& problem = run.problems.front();
  throw Error(Exit::bad_input, fmt::format("{}:{}", file, problem.line), problem.text,
              problem.remedy.empty() ? "correct the line" : problem.remedy);
}

FeedProgram program_blocks(const std::string& file, const job::Profile& profile, bool has_machine) {
  require_program(file);
  const std::string text = read_program_text(file);
  require_own_places(text, file);
  require_runnable(text, file, profile, has_machine);
  const std::vector<PathStep> path = program_run::program_path(text, profile.settings, file);
  const std::vector<std::uint8_t> placed = placed_axes(path, text, profile.settings, file);
  FeedProgram program;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathStep& step = path[i];
    if (step.move.vertices.empty()) {
      lines.push_back(step.text);
      continue;
    }
    std::vector<Block> blocks = blocks_of(step.move, file, program.remarks);
    for (Block& block : blocks) block.placed_axes = placed[i];
    // The plan starts at 0: a rapid to this place has no way in it, and the machine may be
    // elsewhere.
    if (blocks.back().length_mm == 0 && placed[i] != (i == 0 ? 0 : placed[i - 1])) {
      lines.push_back(feed_optimiser::rapid_line(blocks.back()));
      continue;
    }
    // Rapids and feed moves do not share a part: the laser is set before the first feed move.
    const Laser laser = step.move.rapid ? Laser{} : laser_of(step.move);
    if (program.parts.empty() || !lines.empty() || !(program.parts.back().laser == laser)) {
      program.parts.push_back({std::move(lines), laser, {}});
      lines.clear();
    }
    std::vector<Block>& to = program.parts.back().blocks;
    to.insert(to.end(), blocks.begin(), blocks.end());
  }
  program.lines_after = std::move(lines);
  return program;
}

}  // namespace

FeedProgram read_feed_program(const std::string& file, const job::Profile& profile,
                              bool has_machine) {
  const bool is_list = !is_program_name(file) && model::kind_of(file) == model::InputKind::points;
  FeedProgram program = is_list ? polyline(file) : program_blocks(file, profile, has_machine);
  for (const Part& part : program.parts)
    for (const Block& block : part.blocks)
      if (block.length_mm > 0) return program;
  throw no_block(file);
}

}  // namespace lamplock::run
