// `lamplock job`: a job file, made or shown.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/job_points.hpp"
#include "host/cli/mode_name.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/prepare.hpp"
#include "host/cli/staged_file.hpp"
#include "host/job/job_file.hpp"
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
  const points::Bounds box = points::bounds(points_of(job));
  console.say("{}: {} {}s, {}{}", file, job.size(), job.item(), mode_name(job.header.mode),
              job.header.dry ? ", dry" : "");
  const std::size_t pauses = job.is_rows() ? 0 : job.size() - job.points_before(job.size());
  if (pauses > 0) console.say("  {} of them pauses", pauses);
  console.say("  inside {}", bounds_text(box));
  console.say("  made for settings {:08x}, which it states:", job.settings.hash());
  Json overrides = Json::object();
  for (const wire::Override& item : job.header.used_overrides()) {
    const settings::Row& row = settings::row(settings::find_number(item.number));
    const double value = item.value_milli / milli_per_unit;
    overrides[std::string(row.name)] = value;
    console.say("    ${:<3} {} = {:g} {}", item.number, row.name, value, row.unit);
  }
  console.document({{"file", file},
                    {fmt::format("{}s", job.item()), job.size()},
                    {"mode", mode_name(job.header.mode)},
                    {"dry", job.header.dry},
                    {"axes", job.header.axes},
                    {"settings_hash", job.settings.hash()},
                    {"bounds", bounds_json(box)},
                    {"settings", overrides}});
}

/// What is shown is made already.
void check_show(const JobOptions& options) {
  const std::string why = "is for making a job, not for showing one", remedy = "leave it out";
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
    describe(job::read_job_file(options.show), options.show, console);
    return Exit::done;
  }
  if (options.output.empty())
    throw Error(Exit::bad_input, "lamplock job", "where to write is missing", "give -o FILE.llj");
  check_target(options.output);
  options.engraving.check_save();
  check_distinct({{"-o", options.output}, {"--save", options.engraving.save_file()}},
                 options.engraving.input);
  const Work work = make_work(options.engraving, options.dry, console);
  write_whole(options.output, [&work](const auto& path) { job::write_job_file(path, work.job); });
  console.phase("written", options.output);
  if (options.json) describe(work.job, options.output, console);
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
  app.add_option("-o,--output", &options->output, "Job file to write").value_name("FILE.llj");
  app.add_option("--show", &options->show, "Show what is in a job file").value_name("FILE.llj");
  app.add_option("--dry", &options->dry, "A job that moves and never fires");
  app.add_json(options->json);
  app.action([options] { return make_or_show(*options); });
}

}  // namespace lamplock::cli
