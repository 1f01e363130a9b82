// `lamplock jerk`: the feed of a program, optimised by functions of the jerk.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/drive_options.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/run/optimise_feed.hpp"

namespace lamplock::cli {
namespace {

using feed_optimiser::JerkLaw;
using feed_optimiser::OptimisedBlock;
using feed_optimiser::Variant;

struct JerkOptions : run::FeedOptions {
  std::string variant_name = "strict";
  bool no_compare = false;
  bool json = false;
};

Json law_json(const JerkLaw& law) {
  return {{"n", law.n}, {"k", law.k}, {"step_a", law.step_a}, {"step_b", law.step_b}};
}

Json error_json(const program_run::ContourError& error) {
  return {{"mean_mm", error.mean_mm}, {"std_mm", error.deviation_mm}, {"max_mm", error.max_mm}};
}

/// One block: numbers of steps, the points from its begin to its end, and the jerk of each step.
Json segment_json(const OptimisedBlock& block) {
  Json segment = law_json(block.table->law());
  Json points = Json::array();
  for (const geometry::Point& p : feed_optimiser::places(block)) points.push_back({p.x, p.y, p.z});
  segment["line"] = block.block.line;
  segment["length_mm"] = block.block.length_mm;
  segment["time_s"] = block.seconds();
  segment["accelerate"] = block.profile.accelerate;
  segment["hold"] = block.profile.hold;
  segment["brake"] = block.profile.brake;
  segment["points"] = std::move(points);
  segment["jerk"] = feed_optimiser::law_values(block.profile, *block.table);
  return segment;
}

Json comparison_json(const std::vector<run::ComparedFeed>& rows) {
  const auto number = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  Json out = Json::array();
  for (const run::ComparedFeed& row : rows) {
    Json json{{"name", row.name},
              {"time_s", number(row.time_s)},
              {"max_jerk_mm_s3", number(row.max_jerk_mm_s3)},
              {"board", nullptr}};
    if (row.board)
      json["board"] = {{"time_s", row.board->time_s},
                       {"max_jerk_mm_s3", row.board->max_jerk_mm_s3},
                       {"contour_error", error_json(row.board->error)}};
    out.push_back(json);
  }
  return out;
}

Json learned_json(const run::FeedLearned& learned) {
  Json candidates = Json::array();
  for (const run::LearnedLaw& law : learned.candidates) {
    Json json = law_json(law.law);
    json["time_s"] = law.time_s;
    json["contour_error"] = error_json(law.error);
    candidates.push_back(json);
  }
  return {{"candidates", candidates},
          {"time_s", learned.after.time_s},
          {"contour_error", error_json(learned.after.error)},
          {"mean_falls", learned.mean_falls},
          {"std_falls", learned.deviation_falls}};
}

Json document(const JerkOptions& options, const run::OptimisedFeed& feed) {
  Json segments = Json::array();
  for (const OptimisedBlock& block : feed.blocks) segments.push_back(segment_json(block));
  Json json = law_json(feed.method.law);
  json["input"] = options.input;
  json["variant"] = options.variant_name;
  json["period_ms"] = feed.method.period_s * 1e3;
  json["limits"] = {{"speed_mm_s", feed.method.limits.speed_mm_s},
                    {"accel_mm_s2", feed.method.limits.accel_mm_s2},
                    {"jerk_mm_s3", feed.method.limits.jerk_mm_s3}};
  json["time_s"] = feed.time_s;
  json["segments"] = std::move(segments);
  json["comparison"] = comparison_json(feed.compared);
  if (feed.on_machine)
    json["machine"] = {{"time_s", feed.on_machine->optimised_s},
                       {"unchanged_s", feed.on_machine->unchanged_s}};
  if (feed.learned) json["learned"] = learned_json(*feed.learned);
  return json;
}

Exit jerk(JerkOptions options) {
  Console console(options.json);
  options.variant = options.variant_name == "printed" ? Variant::printed : Variant::strict;
  options.compare = !options.no_compare;
  const run::OptimisedFeed feed = run::optimise_feed(options, console);
  if (options.json) console.document(document(options, feed));
  return Exit::done;
}

void add_law(Command& app, JerkOptions& options) {
  const auto number = [&app](const char* name, double& value, const char* text, double low,
                             const char* unit) {
    app.add_option(name, &value, text)
        .check(number_from(low, true))
        .value_name(unit)
        .show_default()
        .group("Law of the jerk");
  };
  app.add_option("--variant", &options.variant_name,
                 "strict: keep all limits at every control period; printed: the tables of the "
                 "patent, whose jerk exceeds the limit")
      .check(one_of({"printed", "strict"}))
      .value_name("printed|strict")
      .show_default()
      .group("Law of the jerk")
      .common();
  number("--n", options.law.n, "Base n of the jerk (n+a)^(k+b), mm/s3", 1, "N");
  number("--k", options.law.k, "Exponent k of the jerk", 0, "K");
  number("--step-a", options.law.step_a, "Increase of a in each control period", 0, "A");
  number("--step-b", options.law.step_b, "Increase of b in each control period", 0, "B");
  app.add_option("--period", &options.period_ms, "Control period")
      .check(number_from(0, false))
      .value_name("MS")
      .show_default()
      .group("Law of the jerk");
}

void add_axis_limits(Command& app, JerkOptions& options) {
  const auto limit = [&app](const char* name, std::vector<double>& values, const char* text,
                            const char* unit) {
    app.add_option(name, &values, text)
        .check(number_from(0, false))
        .count({1, feed_optimiser::axes})
        .value_name(unit)
        .group("Limits")
        .common();
  };
  limit("--max-speed", options.speed_mm_s,
        "Maximum speed of the axes, one number or X,Y,Z; default: of --machine, else 17.5",
        "MM_S,...");
  limit("--max-accel", options.accel_mm_s2,
        "Maximum acceleration, one number or X,Y,Z; default: of --machine, else 1000", "MM_S2,...");
  limit("--max-jerk", options.jerk_mm_s3,
        "Maximum jerk, one number or X,Y,Z; default: of --machine, else 10000", "MM_S3,...");
}

void add_outputs(Command& app, JerkOptions& options) {
  const auto file = [&app](const char* name, std::string& value, const char* text,
                           const char* ending) {
    app.add_option(name, &value, text).value_name("FILE").file(FileUse::write, ending).common();
  };
  file("-o,--output", options.output, "Write the program (G-code) with a feed for each piece", "");
  file("--points", options.points, "Write the intermediate points (CSV)", ".csv");
  file("--chart", options.chart,
       "Write a chart (SVG) of position, speed, acceleration and jerk over time", "");
  app.add_option("--piece-time", &options.piece_ms, "Maximum duration of a piece of --output")
      .check(number_from(0, false))
      .value_name("MS")
      .show_default();
  app.add_option(
         "--learn", &options.learn,
         "Use for each block the law of the jerk with the smallest error on simulated drives")
      .common();
  app.add_option("--no-compare", &options.no_compare,
                 "Omit the table that compares the feed with the firmware's own plan");
}

}  // namespace

void add_jerk(Command& program) {
  Command& app = program.add_command(
      "jerk", "Optimise the feed of a program or polyline by functions of the jerk");
  app.footer(
      "Each line or arc runs from rest to rest: the jerk grows by f(n)^g(k), as in the patent\n"
      "PL 242312 B1; docs/feed-optimiser.md has the theory. The defaults are those of its "
      "example.\n"
      "The table compares the feed with the jerk-limited plan of the firmware and with the exact\n"
      "time optimum. Its contour errors are those of simulated servo drives, see --time-constant.\n"
      "Example:\n"
      "  lamplock jerk part.ngc --max-jerk 20000 -o part-jerk.ngc --chart part.svg\n"
      "  lamplock jerk polyline.xyz --variant printed --n 14 --k 2 --step-a 1 --step-b 0 --json");
  const auto options = std::make_shared<JerkOptions>();
  app.add_option("PROGRAM", &options->input,
                 "G-code program, or list of points (xyz) of a polyline")
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  add_outputs(app, *options);
  add_law(app, *options);
  add_axis_limits(app, *options);
  add_machine(app, options->machine);
  add_servo_drives(app, options->drives, "1.1 times that of X");
  app.add_json(options->json);
  app.action([options] { return jerk(*options); });
}

}  // namespace lamplock::cli
