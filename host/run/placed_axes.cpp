#include "host/run/placed_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "host/error.hpp"
#include "host/feed_optimiser/block.hpp"

namespace lamplock::run {
namespace {

using program_run::PathMove;
using program_run::PathStep;

/// Places that no program names, above and below all that programs do: cycles depend on which side
/// of their planes the machine is.
constexpr PerAxis<double> above_mm{271.8281, 314.1592, 141.4213, 0},
    below_mm{-271.8281, -314.1592, -141.4213, 0};

Error start_error(const std::string& where, const std::string& what) {
  return {Exit::bad_input, where, what,
          "begin the program with G90 and a G0 to its start, as G0 X0 Y0"};
}

bool moves(const PathMove& move, std::size_t axis) {
  return std::any_of(move.vertices.begin(), move.vertices.end(), [&](const auto& vertex) {
    return vertex[axis] != move.vertices.front()[axis];
  });
}

/// Of a move and the same move of the program from the other start.
std::uint8_t placed_by(const PathMove& move, const PathMove& other, const std::string& file) {
  std::uint8_t placed = 0;
  for (std::size_t a = 0; a < feed_optimiser::axes; ++a) {
    const bool before = move.vertices.front()[a] == other.vertices.front()[a],
               after = move.vertices.back()[a] == other.vertices.back()[a];
    if ((moves(move, a) || moves(other, a)) && !(after && (before || move.rapid)))
      throw start_error(
          fmt::format("{}:{}", file, move.line),
          fmt::format("the move depends on where the machine is: the program has given it no place "
                      "along {} yet",
                      "XYZ"[a]));
    if (after) placed = static_cast<std::uint8_t>(placed | 1u << a);
  }
  return placed;
}

std::vector<PathStep> path_from(const PerAxis<double>& start_mm, std::string_view text,
                                const settings::Values& values, const std::string& file) {
  try {
    return program_run::program_path(text, values, file, start_mm);
  } catch (const Error& error) {
    throw start_error(
        file, fmt::format("the program depends on where the machine is ({})", error.message()));
  }
}

bool are_alike(const PathStep& step, const PathStep& other) {
  return step.move.line == other.move.line && step.move.rapid == other.move.rapid &&
         step.move.vertices.empty() == other.move.vertices.empty();
}

}  // namespace

std::vector<std::uint8_t> placed_axes(const std::vector<PathStep>& path, std::string_view text,
                                      const settings::Values& values, const std::string& file) {
  std::vector<std::uint8_t> placed(path.size(), feed_optimiser::all_axes);
  for (const PerAxis<double>& start_mm : {above_mm, below_mm}) {
    const std::vector<PathStep> other = path_from(start_mm, text, values, file);
    std::uint8_t now = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i >= other.size() || !are_alike(path[i], other[i]))
        throw start_error(file, "the moves of the program depend on where the machine is");
      if (!path[i].move.vertices.empty()) now = placed_by(path[i].move, other[i].move, file);
      placed[i] &= now;
    }
  }
  return placed;
}

}  // namespace lamplock::run
