#include "host/cutting/cut_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/cutting/contour_walk.hpp"
#include "host/cutting/depth_model.hpp"
#include "host/error.hpp"

namespace lamplock::cutting {
namespace {

void append_moves(std::vector<CutMove>& moves, const std::vector<Edge>& edges, CutKind kind,
                  double power = 1) {
  for (const Edge& edge : edges) moves.push_back({edge, kind, power});
}

void require_overcut(double overcut_mm, double length_mm) {
  if (overcut_mm >= 0 && overcut_mm <= length_mm) return;
  throw Error(Exit::bad_input, "overcut",
              fmt::format("{:g} mm on a contour of {:.3f} mm", overcut_mm, length_mm),
              "use 0 mm or more, and less than the length of the contour");
}

// A shorter piece is rounding.
constexpr double min_piece_mm = 1e-6;

/// Switches the light off over the first `dark_mm` of a path.
void darken(std::vector<CutMove>& moves, double dark_mm) {
  double along = 0;
  for (std::size_t i = 0; i < moves.size() && along + min_piece_mm < dark_mm; ++i) {
    const double length = length_of(moves[i].edge);
    if (along + length > dark_mm + min_piece_mm) {
      const double part = (dark_mm - along) / length;
      const Edge edge = moves[i].edge;
      const Vec middle = point_at(edge, part);
      CutMove first = moves[i];
      first.edge = cut_out(edge, 0, part, edge.from, middle);
      moves[i].edge = cut_out(edge, part, 1, middle, edge.to);
      moves.insert(moves.begin() + static_cast<std::ptrdiff_t>(i), first);
    }
    moves[i].power = 0;
    along += length;
  }
}

void turn_round(std::vector<CutMove>& moves) {
  std::reverse(moves.begin(), moves.end());
  for (CutMove& move : moves) move.edge = reversed(move.edge);
}

void darken_ends(std::vector<CutMove>& moves, double begin_mm, double end_mm) {
  if (begin_mm == 0 && end_mm == 0) return;
  double length = 0;
  for (const CutMove& move : moves) length += length_of(move.edge);
  if (begin_mm + end_mm + min_piece_mm >= length)
    throw Error(Exit::bad_input, "laser on late, off early",
                fmt::format("{:g} mm at the feed rate is the whole of a contour of {:.3f} mm",
                            begin_mm + end_mm, length),
                "give shorter times, or longer leads");
  darken(moves, begin_mm);
  turn_round(moves);
  darken(moves, end_mm);
  turn_round(moves);
}

}  // namespace

std::vector<CutMove> cut_path(const Contour& contour, const CutPathOptions& options,
                              const CutSheet& sheet) {
  const double length = length_of(contour);
  const double overcut = contour.closed ? options.overcut_mm : 0;
  require_overcut(overcut, length);
  LeadOptions lead{options.lead_in, options.waste, options.clearance_mm, options.neighbours};
  std::vector<CutMove> moves;
  append_moves(moves, lead_in(contour, lead, sheet), CutKind::lead_in);
  double along = 0;
  for (const Tab& tab : tabs_of(contour, options.tabs, overcut)) {
    append_moves(moves, edges_between(contour, along, tab.begin_mm), CutKind::cut);
    append_moves(moves, edges_between(contour, tab.begin_mm, tab.end_mm), CutKind::tab,
                 options.tabs.power);
    along = tab.end_mm;
  }
  append_moves(moves, edges_between(contour, along, length), CutKind::cut);
  append_moves(moves, edges_between(contour, 0, overcut), CutKind::overcut);
  lead.shape = options.lead_out;
  append_moves(moves, lead_out(contour, overcut, lead, sheet), CutKind::lead_out);
  // Points that were computed from both sides are one.
  for (std::size_t i = 0; i + 1 < moves.size(); ++i)
    moves[i].edge = with_ends(moves[i].edge, moves[i].edge.from, moves[i + 1].edge.from);
  darken_ends(moves, options.dark_begin_mm, options.dark_end_mm);
  return moves;
}

std::vector<double> tool_passes(double final_depth_mm, double infeed_mm) {
  const int count = passes_through(final_depth_mm, infeed_mm);
  std::vector<double> z_mm;
  z_mm.reserve(static_cast<std::size_t>(count));
  for (int i = 1; i < count; ++i) z_mm.push_back(-infeed_mm * i);
  z_mm.push_back(-final_depth_mm);
  return z_mm;
}

std::vector<double> focus_passes(double thickness_mm, double depth_of_pass_mm) {
  const int count = passes_through(thickness_mm, depth_of_pass_mm);
  std::vector<double> z_mm;
  z_mm.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) z_mm.push_back(i == 0 ? 0 : -depth_of_pass_mm * i);
  return z_mm;
}

}  // namespace lamplock::cutting
