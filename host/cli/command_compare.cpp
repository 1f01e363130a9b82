// `lamplock compare`: two reports side by side.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/report/summary.hpp"
#include "host/run/report_folder.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

struct CompareOptions {
  std::string first, second;
  bool json = false;
};

/// The two values of each setting that differs, by its name.
Json settings_json(const report::Report& first, const report::Report& second) {
  Json json = Json::object();
  for (const settings::Id id : report::differing_settings(first, second))
    json[std::string(settings::row(id).name)] = {in_units(first.settings, id),
                                                 in_units(second.settings, id)};
  return json;
}

Exit compare(const CompareOptions& options) {
  Console console(options.json);
  const report::Report first = run::read_report(options.first),
                       second = run::read_report(options.second);
  console.text(report::summary(first, second, run::report_names(options.first, options.second)));
  const auto beats = [](const report::Report& r) { return static_cast<double>(r.beats); };
  Json ratio = nullptr;
  if (first.beats > 0) ratio = beats(second) / beats(first);
  console.document({{"first", Json::parse(report::to_json(first))},
                    {"second", Json::parse(report::to_json(second))},
                    {"folders", {options.first, options.second}},
                    {"differing_settings", settings_json(first, second)},
                    {"beats_ratio", ratio}});
  return Exit::done;
}

}  // namespace

void add_compare(Command& program) {
  Command& app =
      program.add_command("compare", "Show two reports side by side, and the settings that differ");
  app.footer(
      "Example:\n  lamplock engrave model.stl --mode start-stop --report stop\n"
      "  lamplock engrave model.stl --mode free --report free\n  lamplock compare stop free");
  const auto options = std::make_shared<CompareOptions>();
  app.add_option("FIRST", &options->first, "Folder of a report")
      .required()
      .value_name("DIR")
      .file(FileUse::folder);
  app.add_option("SECOND", &options->second, "Folder of another report")
      .required()
      .value_name("DIR")
      .file(FileUse::folder);
  app.add_json(options->json, "Print both reports and the ratio of beats as JSON on stdout");
  app.action([options] { return compare(*options); });
}

}  // namespace lamplock::cli
