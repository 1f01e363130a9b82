#include "host/cli/engraving.hpp"

#include <utility>

#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/parameter_options.hpp"
#include "host/cli/prepare.hpp"
#include "host/cli/staged_file.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/description_file.hpp"

namespace lamplock::cli {
namespace {

constexpr const char* input_help =
    "Mesh (stl, obj, ply, 3mf, glb), drawing (dxf, svg), bitmap (png, bmp, jpg), point list (xyz, "
    "csv, cad, ply, dxf), or description of a job (toml)";

/// The folder that a file stands in.
std::filesystem::path folder_of(const std::string& file) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  return folder.empty() ? "." : folder;
}

job::JobOptions job_options(const glass::Description& d, const glass::Volume& volume, bool dry) {
  job::JobOptions options;
  options.mode = mode_named(d.machine.mode);
  options.dry = dry;
  options.shots = static_cast<std::uint8_t>(d.output.flashes);
  options.channel = static_cast<std::uint8_t>(d.output.channel);
  options.energy = static_cast<std::uint16_t>(d.output.energy);
  options.pause_every = static_cast<std::size_t>(d.pause.every_points);
  options.pause_beats = static_cast<std::uint16_t>(d.pause.beats);
  options.refraction = volume.refraction;
  return options;
}

}  // namespace

void EngravingOptions::add_section(Command& app, const std::vector<glass::Parameter>& parameters,
                                   const std::string& group) {
  for (Option* option : add_parameters(app, parameters, group)) options_.push_back(option);
}

void EngravingOptions::add_place(Command& app, bool input_required) {
  app.add_option("INPUT", &input, input_help).required(input_required).value_name("FILE");
  std::vector<glass::Parameter> object = glass::parameters(said_.objects.front());
  object.erase(object.begin());  // the file is INPUT
  add_section(app, object, "Points");
  add_section(app, glass::parameters(said_.glass), "Glass");
  std::vector<glass::Parameter> machine = glass::parameters(said_.machine);
  machine.resize(1);  // the profile
  add_section(app, machine, "Machine");
}

void EngravingOptions::add(Command& app, bool input_required) {
  add_place(app, input_required);
  std::vector<glass::Parameter> machine = glass::parameters(said_.machine);
  machine.erase(machine.begin());  // the profile is there
  add_section(app, machine, "Machine");
  add_section(app, glass::parameters(said_.order), "Order");
  add_section(app, glass::parameters(said_.pause), "Pauses");
  add_section(app, glass::parameters(said_.output), "Output");
}

void EngravingOptions::add_save(Command& app) {
  app.add_option("--save", &save_, "Write what was said here as a description, to repeat it")
      .check(file_name())
      .value_name("FILE.toml");
}

glass::Description EngravingOptions::description() const {
  if (!glass::is_description(input)) {
    glass::Description description = said_;
    description.objects.front().file = input;
    return description;
  }
  refuse_options("has its place in the description", "leave it out and change " + input);
  return glass::read_description(input);
}

void EngravingOptions::refuse_options(const std::string& why, const std::string& remedy) const {
  for (const Option* option : options_)
    if (option->is_given()) throw Error(Exit::bad_input, option->name(), why, remedy);
}

void EngravingOptions::check_save() const {
  if (save_.empty()) return;
  if (!glass::is_description(save_))
    throw Error(Exit::bad_input, save_, "is no name of a description", "name it .toml");
  check_distinct({{"--save", save_}}, input);
  check_target(save_);
}

void EngravingOptions::save(const glass::Description& description, Console& console) const {
  if (save_.empty()) return;
  const std::string text = glass::to_text(description, folder_of(save_));
  write_whole(save_, [&text](const std::filesystem::path& path) { write_file(path, text); });
  console.phase("saved", save_);
}

glass::Volume volume_at(const std::optional<points::Point>& origin,
                        const glass::Description& description, const settings::Values& values) {
  points::Bounds space = work_space_mm(values);
  if (!origin) return glass::volume_of(description.glass, space);
  for (points::Point* p : {&space.low, &space.high})
    *p = {p->x - origin->x, p->y - origin->y, p->z - origin->z};
  return glass::volume_of(description.glass, space, points::Point{});
}

void move_to(const std::optional<points::Point>& origin, points::PointCloud& points,
             glass::Volume& volume) {
  if (!origin) return;
  for (points::Point& p : points) p = {p.x + origin->x, p.y + origin->y, p.z + origin->z};
  volume.refraction.entry_mm += origin->z;
}

Work make_work(const EngravingOptions& options, bool dry, Console& console,
               const std::optional<points::Point>& origin) {
  options.check_save();
  const glass::Description description = options.description();
  const job::Profile profile = profile_of(description.machine);
  glass::Volume volume = volume_at(origin, description, profile.settings);
  Cloud cloud = make_cloud(description, volume, console);
  order_cloud(cloud, description, profile.settings, volume, console);
  move_to(origin, cloud.points, volume);
  Work work{options.input, std::move(cloud.points), {}, std::move(cloud.warnings)};
  work.job = job::make_job(work.points, profile, job_options(description, volume, dry));
  options.save(description, console);
  return work;
}

}  // namespace lamplock::cli
