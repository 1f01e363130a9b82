#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/run/heat.hpp"
#include "host/run/heat_files.hpp"
#include "host/text.hpp"
#include "host/thermal/heat_chart.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {
namespace {

constexpr double hold_mm_min_per_mm_s = 60;

/// "450K", "450", "177C".
double temperature_of(const std::string& text) {
  std::string_view digits = text;
  double zero = 0;
  if (digits.ends_with('K')) {
    digits.remove_suffix(1);
  } else if (digits.ends_with('C')) {
    digits.remove_suffix(1);
    zero = thermal::zero_celsius_k;
  }
  const auto value = lamplock::number_of<double>(digits);
  if (!value)
    throw Error(Exit::bad_input, "--hold", fmt::format("'{}' is not a temperature", text),
                "write it as 450K or 177C");
  return *value + zero;
}

thermal::StraightSetup straight_setup(const HeatOptions& options, const HeatCase& heat) {
  return {heat.body, heat.surface, heat.beam, {}, options.thickness_mm};
}

std::vector<thermal::HeldPair> held_pairs(const thermal::StraightSetup& setup,
                                          const std::vector<double>& feeds_mm_min, double hold_k,
                                          Frontend& frontend) {
  const auto progress = frontend.progress("feeds computed", feeds_mm_min.size(), 0);
  std::vector<thermal::HeldPair> pairs;
  for (const double feed : feeds_mm_min) {
    try {
      pairs.push_back(thermal::held_pair(setup, feed / hold_mm_min_per_mm_s, hold_k));
      require_balance(pairs.back().at.balance);
    } catch (const Error& error) {
      if (error.exit() != Exit::job_failed) throw;
      throw Error(Exit::job_failed, "--hold",
                  fmt::format("no power for {:g} K at {:g} mm/min was found", hold_k, feed),
                  "hold a lower temperature, or leave out losses by --losses");
    }
    progress->update(pairs.size());
  }
  return pairs;
}

std::string held_csv(const std::vector<thermal::HeldPair>& pairs) {
  std::string text = "feed_mm_min,power_w,temperature_k,convection_w,radiation_w,evaporation_w\n";
  for (const thermal::HeldPair& pair : pairs)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.6g},{:.6g},{:.6g}\n",
                   pair.speed_mm_s * hold_mm_min_per_mm_s, pair.power_w, pair.at.max_k,
                   pair.at.losses_w.convection, pair.at.losses_w.radiation,
                   pair.at.losses_w.evaporation);
  return text;
}

void say_pair(const thermal::HeldPair& pair, const HeatCase& heat, Frontend& frontend) {
  const char* note = "";
  if (!pair.at.is_steady)
    note = "  not steady yet";
  else if (heat.laser_w && pair.power_w > *heat.laser_w)
    note = "  more than the laser has";
  const double lost = pair.at.absorbed_w > 0 ? pair.at.losses_w.total() / pair.at.absorbed_w : 0;
  frontend.say("{:>10.4g} mm/min{:>12.4g} W{:>12.1f} K{:>11.3g} %{}",
               pair.speed_mm_s * hold_mm_min_per_mm_s, pair.power_w, pair.at.max_k, 100 * lost,
               note);
}

std::string response_csv(const thermal::LoopResponse& a, const thermal::LoopResponse& b) {
  std::string text = "time_s,set_point_k,set_point_output,absorption_k,absorption_output\n";
  constexpr std::size_t each = 20;
  for (std::size_t i = 0; i < a.times_s.size(); i += each)
    fmt::format_to(std::back_inserter(text), "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", a.times_s[i],
                   a.deviations_k[i], a.outputs[i], b.deviations_k[i], b.outputs[i]);
  return text;
}

/// The loop as settings of the board ($1061 to $1069); throws Error(bad_input) if one of them
/// cannot have its value.
std::vector<std::string> board_lines(const thermal::LoopSettings& loop,
                                     const HeatOptions& options) {
  using settings::Id;
  std::vector<std::string> lines;
  const auto add = [&lines](Id id, double value) {
    const settings::Row& row = settings::row(id);
    const double milli = std::round(value * 1000);
    if (milli == 0 && id != Id::loop_kp)
      throw Error(
          Exit::bad_input, "--tune",
          fmt::format("the board's {} would be 0 {}, with which the loop does nothing: {:g} "
                      "is below its resolution",
                      row.name, row.unit, value),
          "check gain, time constant and sensor");
    if (milli < row.min_milli || milli > row.max_milli)
      throw Error(Exit::bad_input, "--tune",
                  fmt::format("the board's {} is {:g} to {:g} {}, not {:g}", row.name,
                              row.min_milli / 1e3, row.max_milli / 1e3, row.unit, value),
                  "give another settling time, or check gain, time constant and sensor");
    lines.push_back(fmt::format("${}={}", row.number, milli / 1000));
  };
  constexpr double percent = 100, millivolts = 1000;
  if (options.sensor_volts) add(Id::loop_set_point, *options.sensor_volts * millivolts);
  add(Id::loop_kp, loop.kp * percent);
  add(Id::loop_ki, loop.ki_per_s * percent);
  if (options.sensor_k_per_v) add(Id::sensor_scale, *options.sensor_k_per_v);
  if (options.sensor_volts && options.sensor_k_per_v) add(Id::loop, 1);
  return lines;
}

/// Rounds up to milliseconds, so that the loop does not oscillate with the printed time either.
double rounded_up(double seconds) {
  constexpr double per_s = 1000;
  return std::ceil(seconds * per_s) / per_s;
}

/// Throws Error(bad_input) if the loop would oscillate by the delays of a board.
void require_calm(const TunedHeat& tuned, const HeatOptions& options, double part) {
  if (thermal::is_calm(tuned.on_board)) return;
  const thermal::BoardLoop board;
  const auto calm_s = thermal::shortest_on_board(tuned.plant, options.goal, part, board);
  throw Error(
      Exit::bad_input, "--settling",
      fmt::format("with {:g} s the loop would oscillate on the board, whose power acts {:g} "
                  "ms later",
                  options.goal.settling_s, board.delay_s * 1e3),
      calm_s ? fmt::format("give at least {:.3f} s", rounded_up(*calm_s))
             : "use a slower feed or a wider beam: this process is too fast for the board");
}

/// The process of the given gain and time constant, or that of the model.
thermal::Plant plant_of(const HeatOptions& options, Frontend& frontend) {
  if (options.gain_k.has_value() != options.time_constant_s.has_value())
    throw Error(Exit::bad_input, "--tune", "--gain and --time-constant must be given together",
                "give --gain and --time-constant, or neither");
  if (options.gain_k) return thermal::Plant{*options.gain_k, *options.time_constant_s};
  const HeatCase heat = heat_case(options, true);
  if (!options.feed_mm_min)
    throw Error(Exit::bad_input, "--tune", "the feed is not known", "give --feed");
  say_case(heat, frontend);
  return thermal::measured_plant(straight_setup(options, heat),
                                 *options.feed_mm_min / hold_mm_min_per_mm_s, heat.power_w);
}

void say_tuned(const TunedHeat& tuned, Frontend& frontend) {
  frontend.say("process   gain {:.5g} K for a doubled power, time constant {:.4g} s",
               tuned.plant.gain_k, tuned.plant.time_constant_s);
  frontend.say("damping   zeta {:.4f}, omega {:.1f} rad/s", tuned.loop.zeta,
               tuned.loop.omega_rad_s);
  frontend.say("settings  Kp {:.5g} 1/K, Ki {:.5g} 1/(K s), outputs 1 = programmed power",
               tuned.loop.kp, tuned.loop.ki_per_s);
  frontend.say("set point +10 %: settled after {:.4f} s, overshoot {:.2f} %",
               tuned.set_point.settling_s, 100 * tuned.set_point.overshoot);
  frontend.say("absorption +10 %: settled after {:.4f} s, overshoot {:.2f} % of the deviation",
               tuned.absorption.settling_s, 100 * tuned.absorption.overshoot);
  if (thermal::is_calm(tuned.on_board))
    frontend.say("on a board: settled after {:.4f} s, overshoot {:.2f} % of the deviation",
                 tuned.on_board.settling_s, 100 * tuned.on_board.overshoot);
  else
    frontend.say("on a board: oscillates, because its power acts {:g} ms later",
                 thermal::BoardLoop{}.delay_s * 1e3);
  if (!tuned.board_lines.empty()) frontend.say("board     {}", fmt::join(tuned.board_lines, " "));
}

std::string response_picture(const TunedHeat& tuned) {
  const auto& s = tuned.set_point;
  const auto& a = tuned.absorption;
  return thermal::heat_chart(
      {{"time / s",
        "temperature deviation / K",
        {{"set point", s.times_s, s.deviations_k}, {"absorption", a.times_s, a.deviations_k}}},
       {"time / s",
        "output, 1 = programmed power",
        {{"set point", s.times_s, s.outputs}, {"absorption", a.times_s, a.outputs}}}},
      fmt::format("loop with Kp {:.4g}, Ki {:.4g}: steps of 10 %", tuned.loop.kp,
                  tuned.loop.ki_per_s));
}

}  // namespace

HeldHeat held_heat(const HeatOptions& options, Frontend& frontend) {
  check_heat_files(options);
  HeldHeat out;
  out.hold_k = temperature_of(options.hold);
  out.heat = heat_case(options, true);
  const thermal::StraightSetup setup = straight_setup(options, out.heat);
  std::vector<double> feeds = options.feeds_mm_min;
  if (feeds.empty() && options.feed_mm_min) feeds = {*options.feed_mm_min};
  if (feeds.empty()) feeds = {60, 120, 300, 600, 1200};
  say_case(out.heat, frontend);
  out.pairs = held_pairs(setup, feeds, out.hold_k, frontend);
  frontend.say("      feed           power     surface      lost");
  for (const thermal::HeldPair& pair : out.pairs) say_pair(pair, out.heat, frontend);
  double worst = 0;
  for (const thermal::HeldPair& pair : out.pairs)
    worst = std::max(worst, pair.at.balance.relative_error());
  frontend.say("balance   {:.1e} of the absorbed energy is not accounted for", worst);
  if (options.has_check) {
    // Slow beams heat by conduction far around them, where the mesh is coarse.
    const thermal::HeldPair& slowest =
        *std::min_element(out.pairs.begin(), out.pairs.end(),
                          [](const auto& a, const auto& b) { return a.speed_mm_s < b.speed_mm_s; });
    out.refinement = check_refinement(setup, slowest.speed_mm_s, slowest.power_w, frontend);
    say_refinement(*out.refinement, max_body_change, "the powers are rough", frontend);
  }
  const auto picture = [&] {
    thermal::Curve curve;
    for (const thermal::HeldPair& pair : out.pairs) {
      curve.x.push_back(pair.speed_mm_s * hold_mm_min_per_mm_s);
      curve.y.push_back(pair.power_w);
    }
    return thermal::heat_chart({{"feed / mm/min", "power / W", {curve}}},
                               fmt::format("{}: {:g} K held", out.heat.material, out.hold_k));
  };
  write_heat_files(
      options, [&] { return held_csv(out.pairs); }, picture, frontend);
  return out;
}

TunedHeat tuned_heat(const HeatOptions& options, Frontend& frontend) {
  check_heat_files(options);
  TunedHeat out;
  out.plant = plant_of(options, frontend);
  constexpr double set_point_part = 0.1, absorption_part = 0.1;
  out.loop = thermal::tuned_loop(out.plant, options.goal);
  out.set_point =
      thermal::set_point_step(out.plant, out.loop, options.goal, set_point_part * out.plant.gain_k);
  out.absorption = thermal::absorption_step(out.plant, out.loop, options.goal, absorption_part);
  out.on_board = thermal::board_absorption_step(out.plant, out.loop, options.goal, absorption_part,
                                                thermal::BoardLoop{});
  const bool is_for_board = options.sensor_volts || options.sensor_k_per_v;
  if (is_for_board) require_calm(out, options, absorption_part);
  if (thermal::is_calm(out.on_board)) out.board_lines = board_lines(out.loop, options);
  say_tuned(out, frontend);
  write_heat_files(
      options, [&] { return response_csv(out.set_point, out.absorption); },
      [&] { return response_picture(out); }, frontend);
  return out;
}

}  // namespace lamplock::run
