#include "host/run/feed_input.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "host/error.hpp"
#include "host/model/input.hpp"
#include "host/model/read_points.hpp"
#include "host/program/program_path.hpp"
#include "host/run/sent_file.hpp"

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

FeedProgram program_blocks(const std::string& file, const job::Profile& profile) {
  require_program(file);
  const std::string text = read_program_text(file);
  FeedProgram program;
  std::vector<std::string> lines;
  for (const PathStep& step : program_run::program_path(text, profile.settings, file)) {
    if (step.move.vertices.empty()) {
      lines.push_back(step.text);
      continue;
    }
    const std::vector<Block> blocks = blocks_of(step.move, file, program.remarks);
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

FeedProgram read_feed_program(const std::string& file, const job::Profile& profile) {
  const bool is_list = !is_program_name(file) && model::kind_of(file) == model::InputKind::points;
  FeedProgram program = is_list ? polyline(file) : program_blocks(file, profile);
  for (const Part& part : program.parts)
    for (const Block& block : part.blocks)
      if (block.length_mm > 0) return program;
  throw no_block(file);
}

}  // namespace lamplock::run
