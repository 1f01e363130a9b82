// `lamplock order`: points in the order of firing.
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/point_file.hpp"
#include "host/cli/prepare.hpp"
#include "host/model/read_points.hpp"

namespace lamplock::cli {
namespace {

struct Options {
  std::string input, output, order = "layers";
  double layer_mm = order::OrderOptions{}.layer_mm;
  bool json = false;
};

Exit order_points(const Options& options) {
  Console console(options.json);
  check_point_file(options.output);
  if (model::classify(options.input) != model::InputKind::points)
    throw Error(Exit::bad_input, options.input, "is not a point list",
                "make one with lamplock points");
  points::PointCloud cloud = model::read_point_list(options.input);
  console.phase("points",
                fmt::format("{} in {}", cloud.size(), bounds_text(points::bounds(cloud))));
  const bool given = options.order == "given";
  order_cloud(cloud, given ? order::Ordering::given : order::Ordering::layers, options.layer_mm,
              console);
  write_point_file(options.output, cloud);
  console.phase("written", options.output);
  console.document({{"input", options.input},
                    {"output", options.output},
                    {"order", options.order},
                    {"points", cloud.size()},
                    {"bounds", bounds_json(points::bounds(cloud))}});
  return Exit::done;
}

}  // namespace

void add_order(CLI::App& program, Action& action) {
  CLI::App* app = program.add_subcommand("order", "Bring points into the order of firing");
  app->footer("Example:\n  lamplock order points.xyz --layer 0.3 -o ordered.xyz");
  const auto options = std::make_shared<Options>();
  app->add_option("INPUT", options->input, "Point list")->required()->type_name("FILE");
  app->add_option("-o,--output", options->output, "Point list to write, .xyz or .ply")
      ->required()
      ->type_name("FILE");
  app->add_option("--order", options->order,
                  "layers: lowest layer first, short way in it; given: as they come")
      ->check(one_of({"given", "layers"}))
      ->type_name("given|layers")
      ->capture_default_str();
  app->add_option("--layer", options->layer_mm, "Thickness of a layer")
      ->check(number_from(0, false))
      ->type_name("MM")
      ->capture_default_str();
  app->add_flag("--json", options->json, "Print the result as JSON on stdout");
  app->callback([options, &action] { action = [options] { return order_points(*options); }; });
}

}  // namespace lamplock::cli
