#include "host/run/cut_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/duration_text.hpp"
#include "host/number_text.hpp"

namespace lamplock::run {
namespace {

using cutting::PlanPage;
using cutting::Vec;
using program_run::Piece;

/// The place of the beam in the picture.
Vec place_of(const PerAxis<double>& at, bool is_lathe) {
  return is_lathe ? Vec{at[2], at[0]} : Vec{at[0], at[1]};
}

/// Pieces of one move share its time by their length.
void add_path(const program_run::ProgramRun& run, bool is_lathe, PlanPage& page) {
  if (run.pieces.empty() || run.move_ends_s.size() <= run.pieces.back().move) return;
  page.start = place_of(run.pieces.front().from, is_lathe);
  double begin_s = 0;
  for (std::size_t i = 0; i < run.pieces.size();) {
    std::size_t end = i;
    double length = 0;
    const auto length_of = [&](const Piece& piece) {
      return norm(place_of(piece.to, is_lathe) - place_of(piece.from, is_lathe));
    };
    for (; end < run.pieces.size() && run.pieces[end].move == run.pieces[i].move; ++end)
      length += length_of(run.pieces[end]);
    const double end_s = std::max(begin_s, run.move_ends_s[run.pieces[i].move]);
    double passed = 0;
    for (; i < end; ++i) {
      const Piece& piece = run.pieces[i];
      passed += length_of(piece);
      const double part = length > 0 ? passed / length : 1;
      page.path.push_back({place_of(piece.to, is_lathe), piece.power, piece.rapid,
                           begin_s + (end_s - begin_s) * part});
    }
    begin_s = end_s;
  }
}

/// A cut begins where the motion of the one before ends, with the rapid to it.
void add_times(const program_run::ProgramRun& run, const std::vector<std::size_t>& first_lines,
               PlanPage& page) {
  std::size_t piece = 0;
  double now_s = 0;
  for (std::size_t i = 0; i < page.cuts.size() && i < first_lines.size(); ++i) {
    const auto run_to = [&](std::size_t line) {
      for (; piece < page.path.size() && run.pieces[piece].line < line; ++piece)
        now_s = page.path[piece].end_s;
    };
    run_to(first_lines[i]);
    page.cuts[i].begin_s = now_s;
    run_to(i + 1 < first_lines.size() ? first_lines[i + 1]
                                      : std::numeric_limits<std::size_t>::max());
    page.cuts[i].end_s = now_s;
  }
}

}  // namespace

PlanPage cut_page(PlanPage page, const CutProgram& program, const CutResult& result) {
  if (program.run) {
    add_path(*program.run, program.is_lathe, page);
    if (!page.path.empty()) add_times(*program.run, program.first_lines, page);
  }
  const geometry::Bounds& box = result.box;
  if (result.seconds) page.numbers.emplace_back("Time", duration_text(*result.seconds));
  page.numbers.emplace_back("Cuts", grouped(result.cuts));
  page.numbers.emplace_back("To cut, one pass", number_text(result.cut_mm) + " mm");
  page.numbers.emplace_back("Rapids, one pass", number_text(result.rapid_mm) + " mm");
  page.numbers.emplace_back("Size", fmt::format("{} x {} mm", number_text(box.high.x - box.low.x),
                                                number_text(box.high.y - box.low.y)));
  page.warnings = result.warnings;
  return page;
}

}  // namespace lamplock::run
