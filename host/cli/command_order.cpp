// `lamplock order`: points in the order of firing.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/bounds_text.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/ordering.hpp"
#include "host/cli/parameter_options.hpp"
#include "host/cli/point_file.hpp"
#include "host/glass/unused.hpp"
#include "host/model/input.hpp"
#include "host/model/read_points.hpp"

namespace lamplock::cli {
namespace {

struct OrderOptions {
  std::string input, output;
  MachineOptions machine{};
  glass::OrderChoice order{};
  bool json = false;
};

/// The parameters of an order; there are no other layers here.
std::vector<glass::Parameter> parameters_of(glass::OrderChoice& order) {
  std::vector<glass::Parameter> parameters = glass::parameters(order);
  for (glass::Parameter& parameter : parameters)
    if (parameter.key == "layer") parameter.option = "--layer";
  return parameters;
}

void tell_unused(glass::OrderChoice said, const std::string& name, Console& console) {
  glass::OrderChoice untouched;
  for (const std::string& warning :
       glass::unused(parameters_of(said), parameters_of(untouched), glass::way_of_order(name)))
    console.say("warning  {}", warning);
}

Exit order_points(const OrderOptions& options) {
  Console console(options.json);
  check_point_file(options.output);
  if (model::classify(options.input) != model::InputKind::points)
    throw Error(Exit::bad_input, options.input, "is not a point list",
                "make one with lamplock points");
  points::PointCloud cloud = model::read_point_list(options.input);
  console.phase("points",
                fmt::format("{} in {}", cloud.size(), bounds_text(points::bounds(cloud))));
  const std::string name = options.order.name.value_or(default_order);
  tell_unused(options.order, name, console);
  const order::Motion motion = motion_of(options.machine.profile().settings, {});
  order_points(cloud, name, order_options(options.order, {}, motion), console);
  write_point_file(options.output, cloud);
  console.phase("written", options.output);
  console.document({{"input", options.input},
                    {"output", options.output},
                    {"order", name},
                    {"points", cloud.size()},
                    {"bounds", bounds_json(points::bounds(cloud))}});
  return Exit::done;
}

}  // namespace

void add_order(Command& program) {
  Command& app = program.add_command("order", "Bring points into the order of firing");
  app.footer("Example:\n  lamplock order points.xyz --order layers --layer 0.3 -o ordered.xyz");
  const auto options = std::make_shared<OrderOptions>();
  app.add_option("INPUT", &options->input, "Point list").required().value_name("FILE");
  app.add_option("-o,--output", &options->output, "Point list to write: .xyz, .ply or .dxf")
      .required()
      .value_name("FILE");
  for (Option* option : add_parameters(app, parameters_of(options->order), "Order"))
    if (option->name() == "--order")
      option->help(
          "best (default): fewest beats; layers: lowest first, short way in each; serpentine: back "
          "and "
          "forth; nearest: nearest of the layer; cone: cheapest by way and height; given: as they "
          "come");
  options->machine.add_machine(app);
  options->machine.add_overrides(app);
  app.add_json(options->json);
  app.action([options] { return order_points(*options); });
}

}  // namespace lamplock::cli
