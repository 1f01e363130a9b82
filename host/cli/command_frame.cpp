// `lamplock frame`: shows where the object will be.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/engraving.hpp"
#include "host/cli/job_board.hpp"
#include "host/cli/options.hpp"
#include "host/cli/origin.hpp"
#include "host/cli/prepare.hpp"
#include "host/cli/report_job.hpp"
#include "host/cli/run_job.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;

/// Slow enough to watch.
constexpr double default_speed_m_s = 0.05;

struct FrameOptions {
  double speed_m_s = default_speed_m_s;
  EngravingOptions engraving;
  BoardOptions board;
  OriginOption origin;
};

/// The machine's own speeds, none above the wanted one; no lamp is needed where nothing fires.
job::Profile frame_profile(const FrameOptions& options, const glass::Description& description) {
  job::Profile profile = profile_of(description.machine);
  for (int axis = 0; axis < profile.settings.whole(Id::axes); ++axis) {
    const Id id = settings::for_axis(Id::max_rate_x, axis);
    const double own = in_units(profile.settings, id);
    job::state_setting(profile, id, std::min(own, options.speed_m_s * mm_min_per_m_s), "--speed");
  }
  job::state_setting(profile, Id::lamp_mode, static_cast<double>(settings::LampMode::free_beat),
                     "frame");
  return profile;
}

/// Round the box at the height of its top, back to the first corner.
points::PointCloud corners(const points::Bounds& box) {
  const double z = box.high.z;
  return {{box.low.x, box.low.y, z},
          {box.high.x, box.low.y, z},
          {box.high.x, box.high.y, z},
          {box.low.x, box.high.y, z},
          {box.low.x, box.low.y, z}};
}

Exit frame(FrameOptions options) {
  options.board.dry = true;
  const glass::Description description = options.engraving.description();
  options.board.profile = description.machine.profile;
  Console console(options.board.json);
  options.board.check(options.engraving.input);
  auto port = open_job_port(options.board);
  const job::Profile profile = frame_profile(options, description);
  const std::optional<points::Point> origin = options.origin.ask(port.get());
  glass::Volume volume = volume_at(origin, description, profile.settings);
  const points::Bounds box = input_bounds(description, volume);
  console.phase("frame", bounds_text(box));
  job::JobOptions job_options;
  job_options.mode = motion::JoinMode::start_stop;
  job_options.dry = true;
  Work work{options.engraving.input, corners(box), {}, {}};
  move_to(origin, work.points, volume);
  job_options.refraction = volume.refraction;
  work.job = job::make_job(work.points, profile, job_options);
  const Outcome outcome = run_job(work, options.board, std::move(port), console);
  console.document({{"input", options.engraving.input},
                    {"bounds", bounds_json(box)},
                    {"board", options.board.board},
                    {"done", end_name(outcome) == "done"}});
  return tell_end(outcome, options.board, work.job.item());
}

}  // namespace

void add_frame(Command& program) {
  Command& app = program.add_command(
      "frame", "Run round the bounds of an object with firing disabled, at the height of its top");
  app.footer("Example:\n  lamplock frame model.stl --size 40 --board /dev/ttyACM0");
  const auto options = std::make_shared<FrameOptions>();
  options->engraving.add_place(app, true);
  app.add_option("--speed", &options->speed_m_s, "Highest speed, never above the machine's own")
      .check(number_from(0, false))
      .value_name("M_S")
      .show_default()
      .group("Machine");
  options->origin.add(app);
  options->board.add_choice(app);
  options->board.add_job_speed(app);
  app.add_json(options->board.json).group("Board");
  app.action([options] { return frame(*options); });
}

}  // namespace lamplock::cli
