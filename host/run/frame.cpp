#include "host/run/frame.hpp"

#include <algorithm>
#include <utility>

#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/job_board.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/prepare.hpp"
#include "host/run/run_job.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using settings::Id;

/// The machine's own speeds, none above the wanted one; no lamp is needed where nothing fires.
job::Profile frame_profile(double speed_m_s, const glass::Description& description) {
  job::Profile profile = profile_of(description.machine);
  for (int axis = 0; axis < profile.settings.whole(Id::axes); ++axis) {
    const Id id = settings::for_axis(Id::max_rate_x, axis);
    const double own = in_units(profile.settings, id);
    job::state_setting(profile, id, std::min(own, speed_m_s * mm_min_per_m_s), "--speed");
  }
  job::state_setting(profile, Id::lamp_mode, static_cast<double>(settings::LampMode::free_beat),
                     "frame");
  return profile;
}

/// Round the box at the height of its top, back to the first corner.
geometry::PointCloud corners(const geometry::Bounds& box) {
  const double z = box.high.z;
  return {{box.low.x, box.low.y, z},
          {box.high.x, box.low.y, z},
          {box.high.x, box.high.y, z},
          {box.low.x, box.high.y, z},
          {box.low.x, box.low.y, z}};
}

}  // namespace

Framed frame(const JobRequest& request, double speed_m_s, BoardOptions options,
             Frontend& frontend) {
  const glass::Description& description = request.description;
  options.dry = true;
  options.profile = description.machine.profile;
  options.check(input_files(request));
  auto port = open_job_port(options);
  const job::Profile profile = frame_profile(speed_m_s, description);
  const std::optional<geometry::Point> origin = ask_origin(request.origin, port.get());
  glass::Volume volume = volume_at(origin, description, profile.settings);
  const geometry::Bounds box = input_bounds(description, volume);
  frontend.phase("frame", bounds_text(box));
  job::JobOptions job_options;
  job_options.mode = wire::JoinMode::start_stop;
  job_options.dry = true;
  PreparedJob prepared{request.input, corners(box), {}, {}};
  move_to(origin, prepared.points, volume);
  job_options.refraction = volume.refraction;
  prepared.job = job::make_job(prepared.points, profile, job_options);
  return {box, run_job(prepared, options, std::move(port), frontend)};
}

}  // namespace lamplock::run
