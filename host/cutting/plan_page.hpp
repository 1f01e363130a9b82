// The page of a plan: its order over time, its cuts and operations, and its picture.
//
// In:  the picture of the plan, numbers as text, the path of the beam with its times.
// Out: one self-contained HTML file: style, script and data are in it, and it needs no server.
//      Template: host/cutting/page/plan.html, built into the program.
// Who: `lamplock cut --page`.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/cutting/edge.hpp"
#include "host/cutting/operation.hpp"

namespace lamplock::cutting {

/// Paths of more pieces are not drawn over time: the page would be too large a file.
inline constexpr std::size_t max_page_pieces = 500'000;

/// A straight piece of the path of the beam.
struct TimedPiece {
  Vec to;
  double power = 0;  ///< 0 to 1
  bool is_rapid = false;
  double end_s = 0;  ///< since the begin of the program
};

struct PageCut {
  std::size_t number = 1;  ///< in the order of the whole plan
  std::string name, operation;
  double begin_s = 0, end_s = 0;
};

struct PlanPage {
  std::string title, svg;  ///< the picture as plan_svg() makes it
  std::vector<std::string> warnings{};
  std::vector<std::pair<std::string, std::string>> numbers{};  ///< name and value
  std::vector<PageCut> cuts{};                                 ///< in their order
  Vec start{};
  std::vector<TimedPiece> path{};  ///< empty if its times are not known
};

/// The page as text.
std::string plan_page(const PlanPage& page, const std::vector<Operation>& operations);

/// The template, with @PLAN@ and @DATA@ once each.
std::string_view plan_page_text();

}  // namespace lamplock::cutting
