#include "host/material/depth_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "host/error.hpp"
#include "host/material/library.hpp"

namespace lamplock::material {
namespace {

constexpr double seconds_in_minute = 60;

[[noreturn]] void refuse_fit(const Material& material, const std::string& what,
                             const std::string& remedy) {
  throw Error(Exit::bad_input, title_of(material), what, remedy);
}

double required(const Material& material, const std::optional<double>& value, const char* key) {
  if (!value)
    refuse_fit(material, fmt::format("'{}' is missing, which the depth model needs", key),
               fmt::format("edit the material: {}=VALUE", key));
  return *value;
}

Extent extended(const std::optional<Extent>& extent, double value) {
  if (!extent) return {value, value};
  return {std::min(extent->min, value), std::max(extent->max, value)};
}

bool same_place(const Measurement& a, const Measurement& b) {
  return a.feed_mm_min == b.feed_mm_min && a.power_w == b.power_w;
}

/// Depths of one pass, without those that `rejected` omits.
std::vector<Measurement> depths_of(const std::vector<Measurement>& all, Rejected rejected) {
  const auto is_depth = [](const Measurement& m) { return m.depth_mm && m.passes == 1; };
  std::vector<Measurement> depths;
  for (const Measurement& one : all) {
    const bool is_replaced = std::ranges::any_of(all, [&](const Measurement& other) {
      return other.rejected && is_depth(other) && same_place(one, other);
    });
    const bool is_used =
        rejected == Rejected::left_out ? !one.rejected : one.rejected || !is_replaced;
    if (is_depth(one) && is_used) depths.push_back(one);
  }
  return depths;
}

/// The smallest depth at the place of the best cut that is marked as wrong and would need more
/// passes.
std::optional<double> smaller_rejected_depth_mm(const std::vector<Measurement>& measurements,
                                                const BestCut& best) {
  std::optional<double> smallest;
  for (const Measurement& one : measurements)
    if (one.rejected && one.depth_mm && one.passes == 1 && one.feed_mm_min == best.feed_mm_min &&
        one.power_w == best.power_w && *one.depth_mm < smallest.value_or(best.depth_mm.value_or(0)))
      smallest = one.depth_mm;
  return smallest;
}

}  // namespace

double MaterialFit::depth_mm(double at_feed_mm_min, double at_power_w) const {
  cutting::CutSetup at_power = setup;
  at_power.power_w = at_power_w;
  return cutting::cut_depth_mm(at_power, at_feed_mm_min / seconds_in_minute, fit.correction);
}

cutting::CutSetup setup_of(const Laser& laser, const Material& material) {
  cutting::CutSetup setup;
  setup.material = {required(material, material.density_g_cm3, "density_g_cm3"),
                    required(material, material.specific_energy_kj_g, "specific_energy_kj_g"),
                    required(material, material.absorption, "absorption")};
  setup.power_w = laser.power_w;
  setup.beam_width_mm = cutting::effective_width_mm(laser.beam());
  return setup;
}

MaterialFit fit_material(const Laser& laser, const Material& material,
                         const std::vector<Measurement>& measurements, Rejected rejected) {
  MaterialFit result;
  result.setup = setup_of(laser, material);
  std::vector<cutting::MeasuredDepth> depths;
  std::optional<Extent> feeds, powers, ratios;
  for (const Measurement& one : depths_of(measurements, rejected)) {
    // The model knows power and feed by their ratio: a depth at less power is that of full power at
    // a faster feed.
    const double feed_mm_s = one.feed_mm_min / seconds_in_minute * (laser.power_w / one.power_w);
    depths.push_back({feed_mm_s, *one.depth_mm});
    feeds = extended(feeds, one.feed_mm_min);
    powers = extended(powers, one.power_w);
    ratios = extended(ratios, feed_mm_s);
  }
  if (!ratios || ratios->min >= ratios->max)
    refuse_fit(
        material,
        fmt::format("the fit needs depths at two ratios of power to feed with {}, and has {}",
                    laser.name, depths.empty() ? "none" : "one"),
        "measure cuts at two feeds at least");
  result.fit = cutting::fit_depth(result.setup, depths);
  result.measurements = depths.size();
  result.feed_mm_min = *feeds;
  result.power_w = *powers;
  return result;
}

BestCut best_cut(const Material& material, const std::vector<Measurement>& measurements,
                 double thickness_mm, double length_mm, Rejected rejected) {
  if (!material.cuttable)
    refuse_fit(material, "it cannot be cut: it absorbs too little of the power",
               "use another colour or material");
  struct Candidate {
    std::optional<double> depth_mm{};
    int passes = 0;
  };
  std::map<std::pair<double, double>, Candidate> candidates;
  const auto at = [&](const Measurement& one) -> Candidate& {
    return candidates[{one.feed_mm_min, one.power_w}];
  };
  for (const Measurement& one : depths_of(measurements, rejected)) {
    Candidate& candidate = at(one);
    candidate.depth_mm = std::min(candidate.depth_mm.value_or(*one.depth_mm), *one.depth_mm);
    candidate.passes = cutting::passes_through(thickness_mm, *candidate.depth_mm);
  }
  // A sheet of this thickness, or a thicker one, came through.
  for (const Measurement& one : measurements)
    if (!one.rejected && one.result == "cut" &&
        one.thickness_mm.value_or(thickness_mm) >= thickness_mm)
      if (Candidate& candidate = at(one); candidate.passes == 0 || one.passes < candidate.passes)
        candidate = {std::nullopt, one.passes};
  BestCut best;
  std::optional<Extent> feeds, powers;
  for (const auto& [place, candidate] : candidates) {
    const auto& [feed_mm_min, power_w] = place;
    feeds = extended(feeds, feed_mm_min);
    powers = extended(powers, power_w);
    const double time_s =
        cutting::cut_time_s(length_mm, feed_mm_min / seconds_in_minute, candidate.passes);
    if (best.passes != 0 &&
        (time_s > best.time_s || (time_s == best.time_s && candidate.passes >= best.passes)))
      continue;
    best.feed_mm_min = feed_mm_min;
    best.power_w = power_w;
    best.depth_mm = candidate.depth_mm;
    best.passes = candidate.passes;
    best.time_s = time_s;
  }
  if (!feeds)
    refuse_fit(material, fmt::format("there is no measurement for {:g} mm", thickness_mm),
               "measure test cuts first");
  for (const Measurement& one : measurements)
    if (!one.rejected) best.max_measured_passes = std::max(best.max_measured_passes, one.passes);
  best.candidates = candidates.size();
  best.measured_feed_mm_min = *feeds;
  best.measured_power_w = *powers;
  if (rejected == Rejected::left_out)
    best.rejected_depth_mm = smaller_rejected_depth_mm(measurements, best);
  best.burns = best.feed_mm_min <= material.burn_feed_mm_min.value_or(0);
  return best;
}

Suitability judge(const Trial& trial) {
  if (trial.passes && *trial.passes <= max_passes_of_trial)
    return {Verdict::cutting, fmt::format("cut through in {} of at most {} passes", *trial.passes,
                                          max_passes_of_trial)};
  const std::string cut = trial.passes
                              ? fmt::format("needs {} passes to cut through, more than {}",
                                            *trial.passes, max_passes_of_trial)
                              : fmt::format("not cut through in {} passes", max_passes_of_trial);
  if (!trial.groove_mm)
    return {Verdict::unfit, trial.passes
                                ? fmt::format("{}; the groove after {} passes is not given", cut,
                                              max_passes_of_trial)
                                : cut + ", and no groove"};
  const bool is_deep = *trial.groove_mm >= min_groove_mm;
  return {is_deep ? Verdict::engraving : Verdict::unfit,
          fmt::format("{}, a groove of {:g} mm ({} {:g} mm)", cut, *trial.groove_mm,
                      is_deep ? "at least" : "less than", min_groove_mm)};
}

Trial trial_of(const Material& material, const std::vector<Measurement>& measurements,
               double thickness_mm) {
  Trial trial;
  if (!material.cuttable) return trial;
  bool is_known = false;
  for (const Measurement& one : measurements) {
    if (one.rejected) continue;
    const bool has_depth = one.depth_mm && one.passes <= max_passes_of_trial;
    if (has_depth) trial.groove_mm = std::max(trial.groove_mm.value_or(0), *one.depth_mm);
    std::optional<int> passes;
    if (one.depth_mm && one.passes == 1)
      passes = cutting::passes_through(thickness_mm, *one.depth_mm);
    else if (one.result == "cut" && one.thickness_mm.value_or(thickness_mm) >= thickness_mm)
      passes = one.passes;
    if (passes) trial.passes = std::min(trial.passes.value_or(*passes), *passes);
    is_known = is_known || has_depth || passes || !one.result.empty();
  }
  if (!is_known)
    refuse_fit(material, fmt::format("there is no measurement for {:g} mm", thickness_mm),
               "make the trial and give its passes or its groove");
  return trial;
}

}  // namespace lamplock::material
