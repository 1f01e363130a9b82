#include "host/cli/engraving.hpp"

#include "host/cli/prepare.hpp"

namespace lamplock::cli {

void EngravingOptions::add(CLI::App& app, bool input_required) {
  app.add_option("INPUT", input, "Mesh (stl, obj, ply), bitmap (png, bmp) or point list (xyz, ply)")
      ->required(input_required)
      ->type_name("FILE");
  points.add(app);
  order.add(app);
  machine.add_machine(app);
  mode.add(app);
  app.add_option("--flashes", flashes, "Flashes at each point, one after the other")
      ->check(CLI::Range(1u, 255u))
      ->type_name("N")
      ->capture_default_str()
      ->group("Points");
  machine.add_overrides(app);
}

Work make_work(const EngravingOptions& options, bool dry, Console& console) {
  const job::Profile profile = options.machine.profile();
  Cloud cloud = make_cloud(options.input, options.points, work_space_mm(profile.settings), console);
  order_cloud(cloud.points, options.order.ordering(cloud.kind), options.points.layer(), console);
  job::JobOptions job_options;
  job_options.mode = options.mode.mode();
  job_options.dry = dry;
  job_options.shots = static_cast<std::uint8_t>(options.flashes);
  Work work{options.input, std::move(cloud.points), {}};
  work.job = job::make_job(work.points, profile, job_options);
  return work;
}

}  // namespace lamplock::cli
