#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "host/error.hpp"
#include "host/glass/description_file.hpp"
#include "host/number_text.hpp"
#include "host/program/program_path.hpp"
#include "host/run/cut.hpp"
#include "host/run/heat.hpp"
#include "host/run/heat_files.hpp"
#include "host/run/sent_file.hpp"
#include "host/thermal/path_picture.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using program_run::PathLaser;
using program_run::PathStep;
using settings::Id;
using thermal::BeamMove;

/// The field is computed at each step; more would take hours.
constexpr std::size_t max_path_steps = 50'000;

/// A dwell: with light as far as the board permits light at rest, the rest of it dark.
void add_dwell(std::vector<BeamMove>& moves, const PathStep& step, const settings::Values& values,
               double full_power_w) {
  constexpr double percent = 100;
  const double permitted_s =
      step.move.laser == PathLaser::constant ? in_units(values, Id::focus_time) : 0;
  const double lit_s = std::min(step.dwell_s, permitted_s);
  const double part = std::min(in_units(values, Id::focus_power) / percent,
                               step.move.s / in_units(values, Id::max_spindle_speed));
  // A rest is where the beam is.
  BeamMove rest{.line = step.move.line};
  if (!moves.empty()) {
    rest.x0 = rest.x1 = moves.back().x1;
    rest.y0 = rest.y1 = moves.back().y1;
  }
  const auto add = [&](double seconds, double power_w) {
    if (seconds <= 0) return;
    rest.rest_s = seconds;
    rest.power_w = power_w;
    moves.push_back(rest);
  };
  add(lit_s, full_power_w * part);
  add(step.dwell_s - lit_s, 0);
}

/// Moves of a program in the plane; a move of Z alone is a rest.
std::vector<BeamMove> moves_of(const std::vector<PathStep>& steps, const settings::Values& values,
                               double full_power_w) {
  constexpr double min_per_s = 1.0 / 60;
  const double rapid = std::max(in_units(values, Id::max_rate_x, 0) * min_per_s, 1e-3);
  const double max_s = in_units(values, Id::max_spindle_speed);
  std::vector<BeamMove> moves;
  for (const PathStep& step : steps) {
    if (step.dwell_s > 0) add_dwell(moves, step, values, full_power_w);
    if (step.move.vertices.empty()) continue;
    const auto& move = step.move;
    const bool is_lit = move.laser == PathLaser::constant || move.laser == PathLaser::proportional;
    for (std::size_t i = 1; i < move.vertices.size(); ++i) {
      const auto &from = move.vertices[i - 1], &to = move.vertices[i];
      BeamMove one{.line = move.line, .x0 = from[0], .y0 = from[1], .x1 = to[0], .y1 = to[1]};
      one.speed_mm_s = move.rapid || move.feed_mm_s <= 0 ? rapid : move.feed_mm_s;
      one.is_proportional = move.laser == PathLaser::proportional;
      if (is_lit) one.power_w = full_power_w * std::min(1.0, move.s / max_s);
      if (from[0] == to[0] && from[1] == to[1])
        one.rest_s = std::abs(to[2] - from[2]) / one.speed_mm_s;
      if (from[0] == to[0] && from[1] == to[1]) one.power_w = 0;
      moves.push_back(one);
    }
  }
  return moves;
}

std::string program_text(const HeatOptions& options, job::Profile& profile, Frontend& frontend) {
  if (!glass::is_description(options.program)) {
    require_program(options.program);
    return read_program_text(options.program);
  }
  CutRequest request;
  request.description = read_cut_description(options.program);
  request.library = options.library;
  if (options.machine.machine.empty())
    profile = MachineOptions{request.description.machine.profile}.profile();
  return make_cut(request, frontend).program;
}

thermal::PathSetup path_setup(const HeatOptions& options, const HeatCase& heat,
                              const settings::Values& values) {
  thermal::PathSetup setup{heat.body, heat.surface, heat.beam, {}, options.thickness_mm};
  setup.accel_mm_s2 =
      std::min(in_units(values, Id::acceleration_x, 0), in_units(values, Id::acceleration_x, 1));
  setup.deviation_mm = in_units(values, Id::junction_deviation);
  return setup;
}

/// Rows of the table: the nodes below the beam at each step.
class ColumnTable {
 public:
  void add(const thermal::PathSample& sample, const thermal::MovingField& field,
           const std::vector<BeamMove>& moves, double ambient_k) {
    const std::vector<double> now = field.column_k(sample.x, sample.y);
    const auto& depths = field.solver().grid().z.nodes();
    if (last_.size() != now.size()) last_.assign(now.size(), ambient_k);
    for (std::size_t k = 0; k < now.size(); ++k)
      fmt::format_to(std::back_inserter(text_),
                     "{:.9g},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{:.6g},{:.9g},{:.6g}\n",
                     sample.time_s, moves[sample.move].line, sample.x, sample.y, sample.speed_mm_s,
                     sample.power_w, k, depths[k], now[k],
                     (now[k] - last_[k]) / (sample.time_s - last_s_));
    last_ = now;
    last_s_ = sample.time_s;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_ =
      "time_s,line,x_mm,y_mm,speed_mm_s,power_w,node,depth_mm,temperature_k,rate_k_s\n";
  std::vector<double> last_;
  double last_s_ = 0;
};

std::size_t require_steps(const std::vector<BeamMove>& moves, const thermal::PathSetup& setup,
                          const std::string& file) {
  const std::size_t steps = thermal::path_steps(moves, setup);
  if (steps <= max_path_steps) return steps;
  throw Error(Exit::bad_input, file,
              fmt::format("{} time steps are needed, at most {} are possible", grouped(steps),
                          grouped(max_path_steps)),
              "give a part of the program or a wider beam");
}

struct ShownSteps {
  const char* title;
  std::size_t count;
};

/// Runs a path with its progress; `table`: null for none.
thermal::PathResult run_shown(const ShownSteps& steps, const std::vector<BeamMove>& moves,
                              const thermal::PathSetup& setup, ColumnTable* table,
                              Frontend& frontend) {
  const auto progress = frontend.progress(steps.title, steps.count, 0);
  std::size_t done = 0;
  return thermal::run_path(
      moves, setup, [&](const thermal::PathSample& sample, const thermal::MovingField& field) {
        if (table != nullptr) table->add(sample, field, moves, setup.surface.ambient_k);
        progress->update(++done);
        return true;
      });
}

void say_path(const ProgramHeat& out, double usual_k, Frontend& frontend) {
  double max_k = 0;
  for (const thermal::LineHeat& line : out.lines) max_k = std::max(max_k, line.hottest.max_k);
  frontend.say("path      {:.4g} s, usual temperature {:.1f} K, largest {:.1f} K",
               out.result.seconds, usual_k, max_k);
  say_losses(out.result.balance.lost_j, out.result.balance.absorbed_j, frontend);
  frontend.say("balance   {:.1e} of the absorbed energy is not accounted for",
               out.result.balance.relative_error());
}

void say_overheated(const ProgramHeat& out, Frontend& frontend) {
  if (out.overheated.empty()) {
    frontend.say("no line is above {:.0f} K", out.limit_k);
    return;
  }
  constexpr std::size_t max_lines = 20;
  frontend.say("warning   {} above {:.0f} K; to keep each below it, use:",
               count_text(out.overheated.size(), "line"), out.limit_k);
  for (std::size_t i = 0; i < std::min(max_lines, out.overheated.size()); ++i) {
    const thermal::Overheated& one = out.overheated[i];
    std::string feed = "; a greater feed does not help there";
    if (one.feed_factor) feed = fmt::format(" or feed {:.0f} mm/min", *one.feed_mm_min());
    if (one.heat.speed_mm_s == 0) feed = ", or a shorter dwell";
    frontend.say("  line {:>6}{:>9.1f} K at X{:.3f} Y{:.3f}: power {:.4g} W ({:.0f} % of its S){}",
                 one.heat.line, one.heat.hottest.max_k, one.heat.hottest.x, one.heat.hottest.y,
                 one.heat.power_w * one.power_factor, 100 * one.power_factor, feed);
  }
  if (out.overheated.size() > max_lines)
    frontend.say("  and {} more", out.overheated.size() - max_lines);
  if (out.max_with_proposal_k)
    frontend.say("with these powers the path reaches {:.1f} K{}", *out.max_with_proposal_k,
                 *out.max_with_proposal_k > out.limit_k
                     ? ": write them into the program, and compute again"
                     : "");
}

/// Runs the path with the proposed powers, and with the proposed feeds.
void check_proposals(ProgramHeat& out, const std::vector<BeamMove>& moves,
                     const thermal::PathSetup& setup, Frontend& frontend) {
  if (out.overheated.empty()) return;
  const auto run = [&](const char* title, const std::vector<BeamMove>& changed) {
    return run_shown({title, thermal::path_steps(changed, setup)}, changed, setup, nullptr,
                     frontend);
  };
  double max_k = 0;
  for (const thermal::PathSample& sample :
       run("heat with proposed powers", thermal::with_proposed_power(moves, out.overheated))
           .samples)
    max_k = std::max(max_k, sample.max_k);
  out.max_with_proposal_k = max_k;
  if (std::none_of(out.overheated.begin(), out.overheated.end(),
                   [](const thermal::Overheated& one) { return one.feed_factor.has_value(); }))
    return;
  const auto faster = thermal::with_proposed_feed(moves, out.overheated);
  const auto lines = thermal::hottest_of_lines(faster, run("heat with proposed feeds", faster));
  thermal::keep_effective_feeds(out.overheated, lines, out.limit_k, setup.surface.ambient_k);
}

/// The hottest line that moves is computed with a finer mesh.
void check_mesh(ProgramHeat& out, const thermal::PathSetup& setup, Frontend& frontend) {
  const thermal::LineHeat* hottest = nullptr;
  for (const thermal::LineHeat& line : out.lines)
    if (line.speed_mm_s > 0 && (hottest == nullptr || line.hottest.max_k > hottest->hottest.max_k))
      hottest = &line;
  if (hottest == nullptr)
    return frontend.say("refined   no line moves with light: the mesh was not checked");
  out.refinement =
      check_refinement({setup.body, setup.surface, setup.beam, setup.meshing, setup.thickness_mm},
                       hottest->speed_mm_s, hottest->power_w, frontend);
  say_refinement(*out.refinement, max_body_change, "temperatures are rough", frontend);
}

}  // namespace

ProgramHeat heat_of_program(const HeatOptions& options, Frontend& frontend) {
  check_heat_files(options);
  if (options.limit_k && *options.limit_k <= options.ambient_k)
    throw Error(Exit::bad_input, "--limit",
                fmt::format("{:g} K is not above the ambient temperature of {:g} K",
                            *options.limit_k, options.ambient_k),
                "give a higher temperature");
  ProgramHeat out;
  out.heat = heat_case(options, true);
  job::Profile profile = options.machine.profile();
  const std::string text = program_text(options, profile, frontend);
  // Without a machine, M3 and M4 are those of a laser.
  if (options.machine.machine.empty())
    job::state_setting(profile, Id::laser_mode, 1, options.program);
  const std::vector<BeamMove> moves =
      moves_of(program_run::program_path(text, profile.settings, options.program), profile.settings,
               out.heat.power_w);
  if (std::none_of(moves.begin(), moves.end(), [](const BeamMove& m) { return m.power_w > 0; }))
    throw Error(Exit::bad_input, options.program, "no move has the laser on",
                "give it M3 or M4, a power S and a feed");
  const thermal::PathSetup setup = path_setup(options, out.heat, profile.settings);
  const std::size_t steps = require_steps(moves, setup, options.program);
  say_case(out.heat, frontend);
  ColumnTable table;
  out.result =
      run_shown({"heat", steps}, moves, setup, options.csv.empty() ? nullptr : &table, frontend);
  require_balance(out.result.balance);
  out.lines = thermal::hottest_of_lines(moves, out.result);
  const double ambient = setup.surface.ambient_k;
  const double usual = thermal::usual_temperature_k(moves, out.result);
  constexpr double usual_margin = 1.15;
  out.limit_k = options.limit_k.value_or(ambient + usual_margin * (usual - ambient));
  out.overheated = thermal::overheated_lines(out.lines, out.limit_k, ambient);
  say_path(out, usual, frontend);
  check_proposals(out, moves, setup, frontend);
  say_overheated(out, frontend);
  if (options.has_check) check_mesh(out, setup, frontend);
  write_heat_files(
      options, [&] { return table.text(); },
      [&] {
        return thermal::path_picture(
            out.result, moves, out.limit_k,
            fmt::format("{} on {}", std::filesystem::path(options.program).filename().string(),
                        out.heat.material));
      },
      frontend);
  return out;
}

}  // namespace lamplock::run
