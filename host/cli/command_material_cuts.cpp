// `lamplock material measure|fit|best|suitable`: test cuts and what follows from them.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/cli/command_line.hpp"
#include "host/cli/command_material.hpp"
#include "host/cli/console.hpp"
#include "host/cli/material_text.hpp"
#include "host/cli/validators.hpp"
#include "host/duration_text.hpp"
#include "host/number_text.hpp"
#include "host/run/material_card.hpp"
#include "host/run/material_fit.hpp"

namespace lamplock::cli {
namespace {

/// As in the records (host/material/fields.cpp).
constexpr glass::Range cut_feed_range{0, 1'000'000, false}, cut_length_range{0, 10'000, false};
constexpr glass::Range cut_pass_range{1, 1000, true};

struct CutsOptions {
  run::MeasureRequest request;
  std::optional<double> thickness_mm{}, groove_mm{};
  std::optional<int> passes{};
  double length_mm = 100;
  std::string card{};
  bool uses_rejected = false, json = false;
};

material::Rejected use_of(const CutsOptions& options) {
  return options.uses_rejected ? material::Rejected::swapped_in : material::Rejected::left_out;
}

/// "30 to 600 mm/min"; "3 W" if all values are equal.
std::string range_text(double min, double max, const char* unit) {
  return min == max ? fmt::format("{:g} {}", min, unit)
                    : fmt::format("{:g} to {:g} {}", min, max, unit);
}

void say_fit(Console& console, const material::MaterialFit& fit) {
  console.say("fit       {}", fit_text(fit));
  console.say("measured  {}, {}, {}", lamplock::count_text(fit.measurements, "depth"),
              range_text(fit.feed_mm_min.min, fit.feed_mm_min.max, "mm/min"),
              range_text(fit.power_w.min, fit.power_w.max, "W"));
  if (fit.fit.is_poor())
    console.notice(fmt::format(
        "warning  rms {:.3f} is above 0.3: depths deviate from the model by a third and more; "
        "measure more cuts or reject wrong ones",
        fit.fit.rms));
}

void say_best(Console& console, const material::BestCut& best, double thickness_mm,
              double length_mm) {
  console.say("feed      {:g} mm/min", best.feed_mm_min);
  console.say("power     {:g} W", best.power_w);
  console.say("passes    {}{}", best.passes,
              best.depth_mm
                  ? fmt::format(", {:g} mm each, through {:g} mm", *best.depth_mm, thickness_mm)
                  : fmt::format(" came through {:g} mm", thickness_mm));
  console.say("time      {:.2f} min for {:g} mm ({})", best.time_s / 60, length_mm,
              duration_text(best.time_s));
  console.say("measured  {} of feed and power, {}; other feeds are not considered",
              lamplock::count_text(best.candidates, "pair"),
              range_text(best.measured_feed_mm_min.min, best.measured_feed_mm_min.max, "mm/min"));
  if (best.feed_mm_min == best.measured_feed_mm_min.max && best.candidates > 1)
    console.line("note      no faster feed was measured: a faster one may need less time");
  if (best.depth_mm && best.passes > best.max_measured_passes)
    console.notice(fmt::format(
        "warning  the passes are computed, cuts of more than {} were not measured: deeper "
        "passes may remove less; make a test cut",
        lamplock::count_text(static_cast<std::size_t>(best.max_measured_passes), "pass")));
  if (best.rejected_depth_mm)
    console.notice(fmt::format(
        "warning  a rejected measurement at {:g} mm/min has a depth of {:g} mm only; make a test "
        "cut, or add --rejected",
        best.feed_mm_min, *best.rejected_depth_mm));
  if (best.burns)
    console.notice(
        fmt::format("warning  the edges of this material burn at {:g} mm/min", best.feed_mm_min));
}

/// Stores the figures of a card's sheet.
Exit measure_card(const CutsOptions& options) {
  Console console(options.json);
  const run::CardFigures figures = run::measure_card(options.request, options.card);
  console.say("{} with {}: {} added, {} stored before", figures.material, figures.laser,
              lamplock::count_text(figures.added, "measurement"), figures.unchanged);
  if (figures.kerf_mm) console.say("kerf      {:.3f} mm", *figures.kerf_mm);
  console.document({{"material", figures.material},
                    {"laser", figures.laser},
                    {"added", figures.added},
                    {"unchanged", figures.unchanged},
                    {"kerf_mm", figures.kerf_mm ? Json(*figures.kerf_mm) : Json()}});
  return Exit::done;
}

Exit measure(const CutsOptions& options) {
  if (!options.card.empty()) return measure_card(options);
  if (options.request.material.empty())
    throw Error(Exit::bad_input, "lamplock material measure", "NAME is missing",
                "name the material, or give the sheet of a card with --card");
  Console console(options.json);
  const material::Measurement stored = run::measure(options.request);
  console.line(line_of(stored));
  console.document(record_json(stored));
  return Exit::done;
}

Exit fit(const CutsOptions& options) {
  Console console(options.json);
  const run::FitResult result = run::fit_material(options.request, use_of(options));
  console.say("material  {} with {}", result.material.name, result.laser.name);
  say_fit(console, result.fit);
  Json document{{"material", result.material.name}, {"laser", result.laser.name}};
  document.update(fit_json(result.fit));
  console.document(document);
  return Exit::done;
}

Exit best(const CutsOptions& options) {
  Console console(options.json);
  const run::BestResult result =
      run::best_cut(options.request, options.thickness_mm, options.length_mm, use_of(options));
  console.say("material  {} with {}", result.material.name, result.laser.name);
  say_best(console, result.best, result.thickness_mm, options.length_mm);
  Json document{{"material", result.material.name},
                {"laser", result.laser.name},
                {"thickness_mm", result.thickness_mm},
                {"length_mm", options.length_mm}};
  document.update(best_json(result.best));
  console.document(document);
  return Exit::done;
}

const char* verdict_text(material::Verdict verdict) {
  switch (verdict) {
    case material::Verdict::cutting:
      return "fit for cutting";
    case material::Verdict::engraving:
      return "fit for engraving";
    case material::Verdict::unfit:
      break;
  }
  return "unfit";
}

Exit suitable(const CutsOptions& options) {
  Console console(options.json);
  const run::SuitableResult result =
      run::judge_material(options.request, {options.passes, options.groove_mm},
                          options.thickness_mm, options.length_mm);
  const char* const verdict = verdict_text(result.suitability.verdict);
  console.say("{} for {}{}: {}", result.laser.name, result.material.name,
              result.thickness_mm ? fmt::format(" of {:g} mm", *result.thickness_mm) : "", verdict);
  console.say("stage 1   {}{}", result.suitability.reason,
              result.is_by_trial ? "" : ", by the measurements of the library");
  Json document{{"material", result.material.name},
                {"laser", result.laser.name},
                {"verdict", verdict},
                {"reason", result.suitability.reason}};
  if (result.fit) {
    say_fit(console, *result.fit);
    document["fit"] = fit_json(*result.fit);
  }
  if (result.best) {
    say_best(console, *result.best, *result.thickness_mm, options.length_mm);
    document["best"] = best_json(*result.best);
  }
  if (result.suitability.verdict == material::Verdict::cutting && !(result.fit && result.best))
    console.line(
        "stage 2   needs depths of test cuts: make a depth card (lamplock material card), measure "
        "it");
  console.document(document);
  return Exit::done;
}

using CutsPointer = std::shared_ptr<CutsOptions>;

Command& add_cut_command(Command& app, const CutsPointer& options, const std::string& name,
                         const std::string& what, const std::string& footer,
                         Exit (*action)(const CutsOptions&)) {
  Command& sub = app.add_command(name, what);
  sub.footer(footer);
  sub.action([options, action] { return action(*options); });
  sub.add_option("NAME", &options->request.material, "Name of the material")
      .required(name != "measure");
  sub.add_option("--laser", &options->request.laser,
                 "Name of the laser; default: the one of the measurements, or the only one")
      .value_name("NAME");
  sub.add_json(options->json);
  add_library(sub, options->request.library);
  return sub;
}

void add_thickness(Command& sub, std::optional<double>& thickness_mm, const char* help) {
  sub.add_option("--thickness", &thickness_mm, help)
      .check(number_in(cut_length_range))
      .value_name("MM");
}

void add_cut_length(Command& sub, double& length_mm) {
  sub.add_option("--length", &length_mm, "Length of the cut whose time is printed")
      .check(number_in(cut_length_range))
      .value_name("MM")
      .show_default();
}

void add_rejected(Command& sub, CutsOptions& options) {
  sub.add_option("--rejected", &options.uses_rejected,
                 "Use rejected measurements in place of others at the same feed and power");
}

void add_measure(Command& app, const CutsPointer& options) {
  Command& sub = add_cut_command(
      app, options, "measure", "Store the measured depth of a test cut, or whether it came through",
      "Example:\n"
      "  lamplock material measure plywood --feed 180 --power 3 --depth 0.8\n"
      "  lamplock material measure wool --feed 250 --thickness 1.5 --result cut\n"
      "  lamplock material measure --card card.toml",
      measure);
  const Option& card = sub.add_option("--card", &options->card,
                                      "Sheet of a test card with the measured figures: store them")
                           .value_name("FILE")
                           .file(FileUse::read);
  sub.add_option("--feed", &options->request.feed_mm_min, "Feed of the cut")
      .check(number_in(cut_feed_range))
      .value_name("MM_MIN")
      .excludes(card);
  sub.add_option("--power", &options->request.power,
                 "Power of the beam in W, or in percent of the laser's power: 50%; default: all")
      .value_name("POWER")
      .excludes(card);
  sub.add_option("--depth", &options->request.depth_mm, "Depth of the groove after all passes")
      .check(number_in(cut_length_range))
      .value_name("MM")
      .excludes(card);
  sub.add_option("--passes", &options->request.passes, "Number of passes")
      .check(number_in(cut_pass_range))
      .value_name("N")
      .show_default()
      .excludes(card);
  add_thickness(sub, options->request.thickness_mm, "Thickness of the sheet");
  sub.add_option("--result", &options->request.result, "How the cut ended")
      .value_name("cut|almost|not-cut")
      .check(one_of({"cut", "almost", "not-cut"}))
      .excludes(card);
  sub.add_option("--note", &options->request.note, "Remark").value_name("TEXT").excludes(card);
}

}  // namespace

void add_material_cuts(Command& app) {
  const auto options = std::make_shared<CutsOptions>();
  add_measure(app, options);
  Command& fit_command = add_cut_command(
      app, options, "fit",
      "Fit the depth model to measured depths: constants B and w, and the rms of ln D",
      "D = B a / (Q rho s) (P / v)^w: absorption a, specific energy Q, density rho,\n"
      "beam width s, power P, feed v. Depths of one pass count.\n"
      "Example:\n  lamplock material fit pmma-black",
      fit);
  add_rejected(fit_command, *options);
  Command& best_command = add_cut_command(
      app, options, "best", "Find the measured feed and power that cut a thickness fastest",
      "Example:\n  lamplock material best pmma-black --thickness 6", best);
  add_thickness(best_command, options->thickness_mm,
                "Thickness to cut; default: that of the material");
  add_cut_length(best_command, options->length_mm);
  add_rejected(best_command, *options);
  Command& suitable_command = add_cut_command(
      app, options, "suitable",
      "Judge whether a laser can cut or engrave a material, by a trial or by the measurements",
      "Stage 1: a trial at the slowest feed. Cut through within 3 passes: fit for cutting; a "
      "groove\n"
      "of at least 0.5 mm: fit for engraving; otherwise unfit. Stage 2, for cutting: the fit of\n"
      "measured depths and the best feed.\n"
      "Example:\n  lamplock material suitable pmma-black --thickness 6\n"
      "  lamplock material suitable rubber --groove 0.7",
      suitable);
  add_thickness(suitable_command, options->thickness_mm,
                "Thickness to cut; default: that of the material");
  suitable_command
      .add_option("--passes", &options->passes, "Trial: passes after which the cut came through")
      .check(number_in(cut_pass_range))
      .value_name("N");
  suitable_command
      .add_option("--groove", &options->groove_mm,
                  "Trial: depth of the groove, if the cut did not come through")
      .check(number_in({0, 10'000, true}))
      .value_name("MM");
  add_cut_length(suitable_command, options->length_mm);
}

}  // namespace lamplock::cli
