#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/run/heat.hpp"
#include "host/run/heat_files.hpp"
#include "host/thermal/heat_chart.hpp"

namespace lamplock::run {
namespace {

using thermal::DepthResult;
using thermal::DepthSetup;

DepthSetup depth_setup(const HeatOptions& options, const HeatCase& heat) {
  constexpr double mm_min_per_mm_s = 60;
  if (options.step_s > options.time_s)
    throw Error(
        Exit::bad_input, "--step",
        fmt::format("{:g} s is longer than the time of {:g} s", options.step_s, options.time_s),
        "give a shorter step");
  constexpr double max_values = 20e6;
  if (options.time_s / options.step_s * static_cast<double>(options.nodes) > max_values)
    throw Error(Exit::bad_input, "--step", "more than 20 million temperatures would be computed",
                "give a longer step, a shorter time or fewer nodes");
  DepthSetup setup;
  setup.body = heat.body;
  setup.surface = heat.surface;
  setup.source = {options.flux_w_m2.value_or(0) / thermal::w_m2_per_w_mm2, heat.beam, heat.power_w,
                  options.feed_mm_min.value_or(0) / mm_min_per_mm_s};
  setup.depth_mm =
      options.thickness_mm.value_or(thermal::reached_depth_mm(heat.body, options.time_s));
  setup.time_s = options.time_s;
  setup.nodes = options.nodes;
  setup.growth = thermal::depth_growth(options.nodes);
  setup.step_s = options.step_s;
  return setup;
}

std::string depth_csv(const DepthResult& result, double ambient_k) {
  std::string text = "time_s,node,depth_mm,temperature_k,rate_k_s\n";
  for (std::size_t n = 0; n < result.times_s.size(); ++n)
    for (std::size_t k = 0; k < result.depths_mm.size(); ++k)
      fmt::format_to(std::back_inserter(text), "{:.9g},{},{:.9g},{:.9g},{:.9g}\n",
                     result.times_s[n], k, result.depths_mm[k], result.temperatures_k[n][k],
                     result.rate_k_s(n, k, ambient_k));
  return text;
}

std::string depth_picture(const DepthResult& result, double ambient_k, const std::string& title) {
  thermal::ChartPanel profile{"depth / mm", "temperature / K", {}};
  constexpr std::size_t profiles = 5;
  for (std::size_t p = 1; p <= profiles; ++p) {
    const std::size_t n = std::max<std::size_t>(1, result.times_s.size() * p / profiles) - 1;
    const std::string name = fmt::format("{:.3g} s", result.times_s[n]);
    if (!profile.curves.empty() && profile.curves.back().name == name) continue;
    profile.curves.push_back({name, result.depths_mm, result.temperatures_k[n]});
  }
  thermal::Curve surface{"", {0}, {ambient_k}};
  thermal::Curve rate{"", {}, {}};
  for (std::size_t n = 0; n < result.times_s.size(); ++n) {
    surface.x.push_back(result.times_s[n]);
    surface.y.push_back(result.temperatures_k[n].front());
    rate.x.push_back(result.times_s[n]);
    rate.y.push_back(result.rate_k_s(n, 0, ambient_k));
  }
  return thermal::heat_chart({profile,
                              {"time / s", "surface / K", {surface}},
                              {"time / s", "heating rate of the surface / K/s", {rate}}},
                             title);
}

}  // namespace

DepthHeat heat_in_depth(const HeatOptions& options, Frontend& frontend) {
  check_heat_files(options);
  if (options.flux_w_m2 && (options.power_w || options.beam_mm || !options.laser.empty()))
    throw Error(Exit::bad_input, "--flux", "a flux and a beam are given", "give one of them");
  DepthHeat out;
  out.heat = heat_case(options, !options.flux_w_m2);
  const DepthSetup setup = depth_setup(options, out.heat);
  out.result = thermal::run_depth(setup);
  require_balance(out.result.balance);
  say_case(out.heat, frontend);
  frontend.say("depth     {:.4g} mm, {} nodes, steps of {:g} s", setup.depth_mm, setup.nodes,
               out.result.times_s.front());
  frontend.say("surface   {:.2f} K after {:g} s, at most {:.2f} K",
               out.result.temperatures_k.back().front(), setup.time_s, out.result.max_surface_k());
  say_losses(out.result.balance.lost_j, out.result.balance.absorbed_j, frontend);
  frontend.say("balance   {:.1e} of the absorbed energy is not accounted for",
               out.result.balance.relative_error());
  if (options.has_check) {
    out.refinement = thermal::depth_refinement(setup, out.result);
    say_refinement(*out.refinement, max_depth_change, "give more --nodes and a shorter --step",
                   frontend);
  }
  write_heat_files(
      options, [&] { return depth_csv(out.result, setup.surface.ambient_k); },
      [&] {
        return depth_picture(out.result, setup.surface.ambient_k,
                             fmt::format("{}: temperature in depth", out.heat.material));
      },
      frontend);
  return out;
}

}  // namespace lamplock::run
