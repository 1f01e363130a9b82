// Files and remarks that all kinds of `lamplock heat` have.
#pragma once

#include <functional>
#include <string>

#include "host/run/heat.hpp"
#include "host/thermal/straight_run.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) for a picture that is not SVG, and files that cannot be written.
void check_heat_files(const HeatOptions& options);

/// Writes the table and the picture of the options.
void write_heat_files(const HeatOptions& options, const std::function<std::string()>& csv,
                      const std::function<std::string()>& picture, Frontend& frontend);

/// Says how much the largest rise changes with half the mesh and step; warns if that is more than
/// `max_change`.
void say_refinement(double change, double max_change, const std::string& remedy,
                    Frontend& frontend);

/// Change of the rise of a straight track with half the mesh and half the step, over the rise.
double check_refinement(const thermal::StraightSetup& setup, double speed_mm_s, double power_w,
                        Frontend& frontend);

/// Of a column, and of a body, whose mesh is coarser.
inline constexpr double max_depth_change = 0.01, max_body_change = 0.05;

}  // namespace lamplock::run
