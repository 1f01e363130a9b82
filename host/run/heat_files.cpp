#include "host/run/heat_files.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"

namespace lamplock::run {

void check_heat_files(const HeatOptions& options) {
  require_extension(options.picture, ".svg", "pictures of temperatures are written as SVG");
  for (const std::string& file : {options.csv, options.picture})
    if (!file.empty()) check_target(file);
}

void write_heat_files(const HeatOptions& options, const std::function<std::string()>& csv,
                      const std::function<std::string()>& picture, Frontend& frontend) {
  // Both or none.
  std::unique_ptr<StagedFile> table, drawing;
  if (!options.csv.empty()) {
    table = std::make_unique<StagedFile>(options.csv);
    write_file(table->path(), csv());
  }
  if (!options.picture.empty()) {
    drawing = std::make_unique<StagedFile>(options.picture);
    write_file(drawing->path(), picture());
  }
  if (table) {
    table->commit();
    frontend.say("table     {}", options.csv);
  }
  if (drawing) {
    drawing->commit();
    frontend.say("picture   {}", options.picture);
  }
}

double check_refinement(const thermal::StraightSetup& setup, double speed_mm_s, double power_w,
                        Frontend& frontend) {
  const thermal::StraightResult rough = thermal::straight_run(setup, speed_mm_s, power_w);
  const auto progress = frontend.progress("check of the mesh", 2 * rough.steps, 0);
  std::size_t done = 0;
  const thermal::StraightResult fine =
      thermal::straight_run(thermal::refined(setup), speed_mm_s, power_w,
                            [&] { progress->update(std::min(++done, 2 * rough.steps)); });
  return std::abs(fine.max_k - rough.max_k) / (rough.max_k - setup.surface.ambient_k);
}

void say_refinement(double change, double max_change, const std::string& remedy,
                    Frontend& frontend) {
  frontend.say("refined   half the mesh and step change the largest rise by {:.2g} %",
               100 * change);
  if (change > max_change)
    frontend.say("warning   the result is not converged to {:g} %: {}", 100 * max_change, remedy);
}

}  // namespace lamplock::run
