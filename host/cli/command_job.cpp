// `lamplock job`: a job file, made or shown.
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/engraving_options.hpp"
#include "host/file.hpp"
#include "host/job/job.hpp"
#include "host/job/setting_range.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/job_points.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/prepare_job.hpp"
#include "host/run/read_job.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

struct JobOptions {
  EngravingOptions engraving;
  std::string output, show;
  bool dry = false, json = false;
};

/// What is in a job, as text and as JSON.
void describe(const job::Job& job, const std::string& file, Console& console) {
  const geometry::Bounds box = geometry::bounds(run::points_of(job));
  console.say("{}: {} {}s, {}{}", file, job.size(), job.item(), run::mode_name(job.header.mode),
              job.header.dry ? ", dry" : "");
  const std::size_t pauses = job.is_rows() ? 0 : job.size() - job.points_before(job.size());
  if (pauses > 0) console.say("  {} of them pauses", pauses);
  console.say("  inside {}", run::bounds_text(box));
  console.say("  made for settings {:08x}, which it states:", job.settings.hash());
  Json overrides = Json::object();
  for (const wire::Override& item : job.header.used_overrides()) {
    const settings::Row& row = settings::row(settings::find_number(item.number));
    const double value = item.value_milli / milli_per_unit;
    overrides[std::string(row.name)] = value;
    console.say("    ${:<3} {} = {:g}{}", item.number, row.name, value, job::unit_suffix(row));
  }
  console.document({{"file", file},
                    {fmt::format("{}s", job.item()), job.size()},
                    {"mode", run::mode_name(job.header.mode)},
                    {"dry", job.header.dry},
                    {"axes", job.header.axes},
                    {"settings_hash", job.settings.hash()},
                    {"bounds", bounds_json(box)},
                    {"settings", overrides}});
}

/// What is shown is made already.
void check_show(const JobOptions& options) {
  const std::string why = "is used only to make a job, not to show a job file",
                    remedy = "leave it out";
  options.engraving.refuse_options(why, remedy);
  const auto refuse_if = [&](bool given, const char* option) {
    if (given) throw Error(Exit::bad_input, option, why, remedy);
  };
  refuse_if(!options.output.empty(), "-o");
  refuse_if(!options.engraving.save_file().empty(), "--save");
  refuse_if(options.dry, "--dry");
}

Exit make_or_show(const JobOptions& options) {
  Console console(options.json);
  const bool show = !options.show.empty();
  if (show == !options.engraving.input.empty())
    throw Error(Exit::bad_input, "lamplock job", "needs INPUT or --show FILE, one of them",
                "see lamplock job --help");
  if (show) {
    check_show(options);
    describe(run::read_job(options.show), options.show, console);
    return Exit::done;
  }
  if (options.output.empty()) {
    check_is_file(options.engraving.input);
    throw Error(Exit::bad_input, "lamplock job", "no output file is given", "give -o FILE.llj");
  }
  const job::Job job =
      run::make_job_file(options.engraving.request(), options.dry, options.output, console);
  if (options.json) describe(job, options.output, console);
  return Exit::done;
}

}  // namespace

void add_job(Command& program) {
  Command& app = program.add_command("job", "Make a job file to send later, or show one");
  app.footer(
      "Example:\n  lamplock job model.stl --size 40 --spacing 0.3 -o model.llj\n"
      "  lamplock job --show model.llj");
  const auto options = std::make_shared<JobOptions>();
  options->engraving.add(app, false);
  options->engraving.add_save(app);
  app.add_option("-o,--output", &options->output, "Job file to write")
      .value_name("FILE.llj")
      .file(FileUse::write)
      .common();
  app.add_option("--show", &options->show, "Show the contents of a job file")
      .value_name("FILE.llj")
      .file(FileUse::read);
  app.add_option("--dry", &options->dry, "Make a job that moves without firing");
  app.add_json(options->json);
  app.action([options] { return make_or_show(*options); });
}

}  // namespace lamplock::cli
