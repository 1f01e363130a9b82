// `lamplock order`: points in the order of firing.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/parameter_options.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/run/make_points.hpp"
#include "host/run/ordering.hpp"

namespace lamplock::cli {
namespace {

struct OrderOptions {
  run::OrderRequest request{};
  bool json = false;
};

/// The parameters of an order; there are no other layers here.
std::vector<glass::Parameter> parameters_of(glass::OrderChoice& order) {
  std::vector<glass::Parameter> parameters = glass::parameters(order);
  for (glass::Parameter& parameter : parameters)
    if (parameter.key == "layer") parameter.option = "--layer";
  return parameters;
}

void warn_of_unused(glass::OrderChoice given, const std::string& name, Console& console) {
  glass::OrderChoice untouched;
  for (const std::string& warning :
       glass::unused(parameters_of(given), parameters_of(untouched), glass::way_of_order(name)))
    console.say("warning  {}", warning);
}

Exit order_points(OrderOptions options) {
  Console console(options.json);
  run::OrderRequest& request = options.request;
  request.order = request.choice.name.value_or(run::default_order);
  warn_of_unused(request.choice, request.order, console);
  const geometry::PointCloud cloud = run::order_point_list(request, console);
  console.document({{"input", request.input},
                    {"output", request.output},
                    {"order", request.order},
                    {"points", cloud.size()},
                    {"bounds", bounds_json(geometry::bounds(cloud))}});
  return Exit::done;
}

}  // namespace

void add_order(Command& program) {
  Command& app = program.add_command("order", "Sort points into firing order");
  app.footer("Example:\n  lamplock order points.xyz --order layers --layer 0.3 -o ordered.xyz");
  const auto options = std::make_shared<OrderOptions>();
  app.add_option("INPUT", &options->request.input, "Point list")
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  app.add_option("-o,--output", &options->request.output, "Point list to write: .xyz, .ply or .dxf")
      .required()
      .value_name("FILE")
      .file(FileUse::write);
  for (Option* option : add_parameters(app, parameters_of(options->request.choice), "Order"))
    if (option->name() == "--order")
      option->help(
          "best: fewest beats; layers: lowest layer first, a short path in each; "
          "serpentine: back and forth in each layer; nearest: nearest point of the layer; cone: "
          "point with the lowest cost of distance and height; given: order of the file; default: "
          "best");
  add_machine(app, options->request.machine);
  add_machine_overrides(app, options->request.machine);
  app.add_json(options->json);
  app.action([options] { return order_points(*options); });
}

}  // namespace lamplock::cli
