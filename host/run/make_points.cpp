#include "host/run/make_points.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <utility>
#include <variant>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/output_files.hpp"
#include "host/geometry/bounds.hpp"
#include "host/glass/description_file.hpp"
#include "host/model/input.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/file_ways.hpp"
#include "host/run/frontend.hpp"
#include "host/run/ordering.hpp"
#include "host/run/point_file.hpp"
#include "host/run/prepare.hpp"
#include "host/run/prepare_job.hpp"
#include "host/shell_text.hpp"

namespace lamplock::run {
namespace {

geometry::PointCloud point_list(const std::string& file) {
  refuse_finished(file);
  const bool is_description = glass::is_description(file);
  if (is_description) check_is_file(file);
  if (!is_description && model::may_hold(file, model::InputKind::points)) {
    model::Input input = model::read_input(file);
    if (auto* cloud = std::get_if<geometry::PointCloud>(&input)) return std::move(*cloud);
  }
  const std::string list = std::filesystem::path(file).replace_extension(".xyz").string();
  throw Error(Exit::bad_input, file, "is not a point list",
              fmt::format("make one of it: lamplock points {} -o {}", shell_text({file}),
                          shell_text({list})));
}

}  // namespace

Cloud make_points(const JobRequest& request, const std::string& output, Frontend& frontend) {
  check_point_file(output);
  check_distinct({{"-o", output}, {"--save", request.save}}, input_files(request));
  const glass::Description& description = request.description;
  const job::Profile profile = profile_of(description.machine);
  const glass::Volume volume = glass::volume_of(description.glass, work_space_mm(profile.settings));
  Cloud cloud = make_cloud(description, volume, frontend);
  write_point_file(output, cloud.points);
  frontend.phase("written", output);
  save_description(request, frontend);
  show_hints(cloud, frontend);
  return cloud;
}

geometry::PointCloud order_point_list(const OrderRequest& request, Frontend& frontend) {
  check_point_file(request.output);
  geometry::PointCloud cloud = point_list(request.input);
  frontend.phase("points",
                 fmt::format("{} in {}", cloud.size(), bounds_text(geometry::bounds(cloud))));
  const order::Motion motion = motion_of(request.machine.profile().settings, {});
  order_points(cloud, request.order, order_options(request.choice, {}, motion), frontend);
  write_point_file(request.output, cloud);
  frontend.phase("written", request.output);
  return cloud;
}

}  // namespace lamplock::run
