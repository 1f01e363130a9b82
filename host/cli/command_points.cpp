// `lamplock points`: a model becomes points.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/engraving_options.hpp"
#include "host/run/make_points.hpp"
#include "host/run/prepare.hpp"
#include "host/run/prepare_job.hpp"

namespace lamplock::cli {
namespace {

struct PointsOptions {
  std::string output;
  bool json = false;
  EngravingOptions engraving;
};

Exit make_points(const PointsOptions& options) {
  Console console(options.json);
  const run::JobRequest request = options.engraving.request();
  const run::Cloud cloud = run::make_points(request, options.output, console);
  console.document({{"input", request.input},
                    {"kind", cloud.kind},
                    {"output", options.output},
                    {"points", cloud.points.size()},
                    {"welded", cloud.welded},
                    {"rejected", cloud.rejected},
                    {"empty_share", cloud.empty_share},
                    {"spacing", spacing_json(cloud.spacing)},
                    {"bounds", bounds_json(geometry::bounds(cloud.points))},
                    {"warnings", cloud.warnings}});
  return Exit::done;
}

}  // namespace

void add_points(Command& program) {
  Command& app = program.add_command(
      "points", "Convert a mesh, drawing, bitmap or job description to a point list");
  app.footer(
      "Example:\n  lamplock points model.stl --size 40 --spacing 0.3 -o points.xyz\n"
      "  lamplock points model.stl --block 50,50,80 --lens f43 --transform \"rotate z 30\" \\\n"
      "      --transform fit -o points.ply --save block.toml");
  const auto options = std::make_shared<PointsOptions>();
  options->engraving.add_place(app, true);
  app.add_option("-o,--output", &options->output, "Point list to write: .xyz, .ply or .dxf")
      .required()
      .value_name("FILE")
      .file(FileUse::write);
  app.add_json(options->json);
  options->engraving.add_save(app);
  // Those that matter more for points than for a whole job.
  for (Option& option : app.options())
    for (const char* name : {"--up", "--transform", "--layer", "--block"})
      if (option.name() == name) option.common();
  app.action([options] { return make_points(*options); });
}

}  // namespace lamplock::cli
