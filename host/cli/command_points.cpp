// `lamplock points`: a model becomes points.
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/point_file.hpp"
#include "host/cli/prepare.hpp"

namespace lamplock::cli {
namespace {

struct Options {
  std::string input, output;
  bool json = false;
  PointsOptions points;
  MachineOptions machine;
};

Exit make_points(const Options& options) {
  Console console(options.json);
  check_point_file(options.output);
  const job::Profile profile = options.machine.profile();
  const Cloud cloud =
      make_cloud(options.input, options.points, work_space_mm(profile.settings), console);
  write_point_file(options.output, cloud.points);
  console.phase("written", options.output);
  console.document({{"input", options.input},
                    {"kind", kind_name(cloud.kind)},
                    {"output", options.output},
                    {"points", cloud.points.size()},
                    {"welded", cloud.welded},
                    {"bounds", bounds_json(points::bounds(cloud.points))}});
  return Exit::done;
}

}  // namespace

void add_points(CLI::App& program, Action& action) {
  CLI::App* app = program.add_subcommand("points", "Turn a mesh or bitmap into points");
  app->footer("Example:\n  lamplock points model.stl --size 40 --spacing 0.3 -o points.xyz");
  const auto options = std::make_shared<Options>();
  app->add_option("INPUT", options->input, "Mesh (stl, obj, ply), bitmap (png, bmp) or point list")
      ->required()
      ->type_name("FILE");
  app->add_option("-o,--output", options->output, "Point list to write, .xyz or .ply")
      ->required()
      ->type_name("FILE");
  app->add_flag("--json", options->json, "Print the result as JSON on stdout");
  options->points.add(*app);
  options->machine.add_machine(*app);
  app->callback([options, &action] { action = [options] { return make_points(*options); }; });
}

}  // namespace lamplock::cli
