// `lamplock points`: a model becomes points.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/point_file.hpp"
#include "host/cli/prepare.hpp"

namespace lamplock::cli {
namespace {

struct PointsOptions {
  std::string output;
  bool json = false;
  EngravingOptions engraving;
};

Exit make_points(const PointsOptions& options) {
  Console console(options.json);
  check_point_file(options.output);
  options.engraving.check_save();
  check_distinct({{"-o", options.output}, {"--save", options.engraving.save_file()}});
  const glass::Description description = options.engraving.description();
  const job::Profile profile = profile_of(description.machine);
  const glass::Volume volume = glass::volume_of(description.glass, work_space_mm(profile.settings));
  const Cloud cloud = make_cloud(description, volume, console);
  write_point_file(options.output, cloud.points);
  console.phase("written", options.output);
  options.engraving.save(description, console);
  console.document({{"input", options.engraving.input},
                    {"kind", cloud.kind},
                    {"output", options.output},
                    {"points", cloud.points.size()},
                    {"welded", cloud.welded},
                    {"rejected", cloud.rejected},
                    {"spacing", spacing_json(cloud.spacing)},
                    {"bounds", bounds_json(points::bounds(cloud.points))},
                    {"warnings", cloud.warnings}});
  return Exit::done;
}

}  // namespace

void add_points(Command& program) {
  Command& app = program.add_command(
      "points",
      "Turn a mesh, drawing or bitmap into points, or a description into all of its points");
  app.footer(
      "Example:\n  lamplock points model.stl --size 40 --spacing 0.3 -o points.xyz\n"
      "  lamplock points model.stl --block 50,50,80 --lens f43 --transform \"rotate z 30\" \\\n"
      "      --transform fit -o points.ply --save block.toml");
  const auto options = std::make_shared<PointsOptions>();
  options->engraving.add_place(app, true);
  app.add_option("-o,--output", &options->output, "Point list to write: .xyz, .ply or .dxf")
      .required()
      .value_name("FILE");
  app.add_json(options->json);
  options->engraving.add_save(app);
  app.action([options] { return make_points(*options); });
}

}  // namespace lamplock::cli
