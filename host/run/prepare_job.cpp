#include "host/run/prepare_job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <utility>

#include "host/file/output_files.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/job/job.hpp"
#include "host/job/job_file.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/prepare.hpp"
#include "host/run/sent_file.hpp"
#include "host/run/unsaved_option.hpp"

namespace lamplock::run {
namespace {

/// The folder of a file.
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

/// What the report says about the job.
report::Making making_of(const glass::Description& description, const Cloud& cloud) {
  report::Making making;
  making.spacing_mm = cloud.spacing_mm;
  making.method = fmt::format("{}", fmt::join(cloud.ways, ", "));
  making.order = order_name(cloud, description.order);
  making.material = description.glass.material.value_or("");
  return making;
}

}  // namespace

glass::Volume volume_at(const std::optional<geometry::Point>& origin,
                        const glass::Description& description, const settings::Values& values) {
  geometry::Bounds space = work_space_mm(values);
  if (!origin) return glass::volume_of(description.glass, space);
  for (geometry::Point* p : {&space.low, &space.high})
    *p = {p->x - origin->x, p->y - origin->y, p->z - origin->z};
  return glass::volume_of(description.glass, space, geometry::Point{});
}

void move_to(const std::optional<geometry::Point>& origin, geometry::PointCloud& points,
             glass::Volume& volume) {
  if (!origin) return;
  for (geometry::Point& p : points) p = {p.x + origin->x, p.y + origin->y, p.z + origin->z};
  volume.refraction.entry_mm += origin->z;
}

std::vector<std::string> input_files(const JobRequest& request) {
  std::vector<std::string> files{request.input, request.description.machine.profile};
  for (const glass::Object& object : request.description.objects) files.push_back(object.file);
  return files;
}

PreparedJob prepare_job(const JobRequest& request, bool dry,
                        const std::optional<geometry::Point>& origin, Frontend& frontend) {
  const glass::Description& description = request.description;
  const job::Profile profile = profile_of(description.machine);
  glass::Volume volume = volume_at(origin, description, profile.settings);
  Cloud cloud = make_cloud(description, volume, frontend);
  order_cloud(cloud, description, profile.settings, volume, frontend);
  move_to(origin, cloud.points, volume);
  PreparedJob prepared{request.input,
                       std::move(cloud.points),
                       {},
                       std::move(cloud.warnings),
                       making_of(description, cloud)};
  prepared.job = job::make_job(prepared.points, profile, job_options(description, volume, dry));
  save_description(request, frontend);
  show_hints(cloud, frontend);
  return prepared;
}

job::Job make_job_file(const JobRequest& request, bool dry, const std::string& output,
                       Frontend& frontend) {
  check_job_name(output);
  check_target(output);
  refuse_unsaved(request.save, dry, "--dry");
  check_distinct({{"-o", output}, {"--save", request.save}}, input_files(request));
  PreparedJob prepared = prepare_job(request, dry, std::nullopt, frontend);
  write_whole(output, [&prepared](const auto& path) { job::write_job_file(path, prepared.job); });
  frontend.phase("written", output);
  return std::move(prepared.job);
}

void save_description(const JobRequest& request, Frontend& frontend) {
  if (request.save.empty()) return;
  const std::string text = glass::to_text(request.description, folder_of(request.save));
  write_whole(request.save, text);
  frontend.phase("saved", request.save);
}

}  // namespace lamplock::run
