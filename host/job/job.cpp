#include "host/job/job.hpp"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <span>
#include <string>

#include "host/error.hpp"
#include "host/job/step_rounder.hpp"
#include "host/units.hpp"

namespace lamplock::job {
namespace {

using settings::Id;

/// Settings that define the position of a step: without them the targets have no meaning.
constexpr std::array geometry{Id::steps_per_mm_x, Id::travel_x, Id::min_corner_x};

void add_override(wire::JobHeader& header, Id id, const settings::Values& values) {
  const std::uint16_t number = settings::row(id).number;
  for (const wire::Override& item : header.used_overrides())
    if (item.number == number) return;
  header.overrides[header.override_count++] = {number, values.milli(id)};
}

void require_size(std::size_t targets) {
  if (targets <= std::numeric_limits<std::uint32_t>::max()) return;
  throw Error(Exit::bad_input, "job", "too many points", "split the job");
}

void check(const geometry::PointCloud& points, const JobOptions& options) {
  if (points.empty())
    throw Error(Exit::bad_input, "job", "there are no points",
                "check the model, the method and the spacing");
  require_size(points.size());
  if (options.shots == 0 || options.channel > wire::max_channel)
    throw Error(Exit::bad_input, "job", "the number of flashes or the channel is out of range",
                "use 1..255 flashes and channel 0..3");
  if (options.pause_every != 0 && options.pause_beats == 0)
    throw Error(Exit::bad_input, "job", "a pause has 0 beats", "give 1..65535 beats");
}

/// A pause at the position of `target`.
wire::Target pause_at(const wire::Target& target, std::uint16_t beats) {
  return {target.steps, beats, 0, 0, 0};
}

/// A pause of the firmware lasts at most 8192 beats, and 2147 s (motion/profile/reach.hpp); a
/// longer one is made of several.
void add_pause(std::vector<wire::Target>& targets, std::uint16_t beats) {
  constexpr std::uint16_t longest = 2000;
  for (std::uint16_t left = beats; left != 0;) {
    const std::uint16_t part = std::min(left, longest);
    targets.push_back(pause_at(targets.back(), part));
    left = static_cast<std::uint16_t>(left - part);
  }
}

/// Converts points to targets, with the pauses between them.
std::vector<wire::Target> targets_of(const geometry::PointCloud& points, const Profile& profile,
                                     const JobOptions& options) {
  const std::size_t every = options.pause_every;
  std::vector<wire::Target> targets;
  targets.reserve(points.size() + (every != 0 ? points.size() / every : 0));
  const Rounder rounder(profile.settings);
  std::size_t outside = 0, first_outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (every != 0 && i != 0 && i % every == 0) add_pause(targets, options.pause_beats);
    wire::Target target{{}, 0, options.shots, options.channel, options.energy};
    if (!rounder.round(options.refraction.stage(points[i]), target.steps) && outside++ == 0)
      first_outside = i;
    targets.push_back(target);
  }
  if (outside == 0) return targets;
  const geometry::Point& point = points[first_outside];
  throw Error(Exit::bad_input, fmt::format("point {}", first_outside),
              fmt::format("({:g}, {:g}, {:g}) mm is outside the work space ({} of {} points are)",
                          point.x, point.y, point.z, outside, points.size()),
              fmt::format("keep to {}", describe_work_space(profile.settings)));
}

}  // namespace

wire::JobHeader make_header(const Profile& profile, const JobOptions& options,
                            std::size_t targets) {
  const settings::Values& values = profile.settings;
  wire::JobHeader header;
  header.axes = static_cast<std::uint8_t>(values.whole(Id::axes));
  header.mode = static_cast<std::uint8_t>(options.mode);
  header.dry = options.dry;
  header.points_total = static_cast<std::uint32_t>(targets);
  header.settings_hash = options.check_settings ? values.hash() : 0;
  add_override(header, Id::axes, values);
  for (const Id x_row : geometry)
    for (int axis = 0; axis < header.axes; ++axis)
      add_override(header, settings::for_axis(x_row, axis), values);
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<Id>(i);
    const bool changed = values.milli(id) != settings::row(id).default_milli;
    if (settings::of_jobs(id) && (profile.stated[i] || changed)) add_override(header, id, values);
  }
  return header;
}

bool Job::keeps_to_lamp() const {
  const auto mode = static_cast<settings::LampMode>(settings.whole(Id::lamp_mode));
  return !is_rows() && mode != settings::LampMode::free_beat;
}

bool Job::is_pause(std::size_t target) const {
  const wire::Target& t = targets[target];
  return t.shots == 0 && t.beats != 0 && target > 0 && t.steps == targets[target - 1].steps;
}

std::size_t Job::points_before(std::size_t target) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < target; ++i) count += is_pause(i) ? 0u : 1u;
  return count;
}

Job make_job(const geometry::PointCloud& points, const Profile& profile,
             const JobOptions& options) {
  check(points, options);
  Job job;
  job.settings = profile.settings;
  job.refraction = options.refraction;
  job.targets = targets_of(points, profile, options);
  require_size(job.targets.size());
  job.header = make_header(profile, options, job.targets.size());
  return job;
}

wire::JobHeader header_from(const Job& job, std::size_t first) {
  wire::JobHeader header = job.header;
  header.first_index = static_cast<std::uint32_t>(first);
  if (first > 0)
    header.origin_steps =
        job.is_rows() ? job.rows.lines[first - 1].to.steps : job.targets[first - 1].steps;
  return header;
}

settings::Values apply_overrides(const settings::Values& base, const wire::JobHeader& header,
                                 const std::string& where) {
  settings::Values values = base;
  for (const wire::Override& item : header.used_overrides()) {
    const Id id = settings::find_number(item.number);
    if (id == Id::count || !values.set_milli(id, item.value_milli))
      throw Error(Exit::bad_input, where,
                  fmt::format("setting ${} = {:.3f} is unknown or out of range", item.number,
                              item.value_milli / milli_per_unit),
                  "make the job again with this version of lamplock");
  }
  return values;
}

RecordEncoder::RecordEncoder(const Job& job, std::size_t first) : job_(&job), index_(first) {
  state_.steps = header_from(job, first).origin_steps;
  if (job.is_rows()) rows_.emplace(job.rows, first, state_.steps, job.header.axes);
}

std::vector<std::uint8_t> RecordEncoder::next(std::size_t max_bytes, std::size_t max_points) {
  if (rows_) {
    std::vector<std::uint8_t> records = rows_->next(max_bytes, max_points);
    index_ = rows_->index();
    return records;
  }
  std::vector<std::uint8_t> payload(max_bytes);
  wire::ByteWriter out(payload);
  for (std::size_t count = 0; count < max_points && index_ < job_->targets.size(); ++count) {
    if (out.room() < wire::max_record_size) break;
    const wire::Target& t = job_->targets[index_];
    if (!wire::put_record(out, state_, {t.steps, t.beats, t.shots, t.channel, t.energy},
                          job_->header.axes))
      throw Error(Exit::bad_input, fmt::format("point {}", index_),
                  "is too far from the one before, or uses an axis the machine lacks",
                  "move the points into the work space");
    ++index_;
  }
  payload.resize(out.size());
  return payload;
}

}  // namespace lamplock::job
