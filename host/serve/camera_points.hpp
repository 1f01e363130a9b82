// The calibration of the camera: four places of its picture with their places on the machine.
//
// In:  four points of a client. Out: the points, checked and kept in a file. Who: the methods
//      camera.get and camera.calibrate. A page makes the perspective map of them.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace lamplock::serve {

/// Null if there are none, or if the file is damaged.
nlohmann::json read_camera_points(const std::filesystem::path& file);

/// `points`: four objects with `u` and `v` (0 to 1, from the left and from the top of the picture)
/// and `x` and `y` (mm of the machine). Throws Error(bad_input): another form, three of them on a
/// line.
void write_camera_points(const std::filesystem::path& file, const nlohmann::json& points);

}  // namespace lamplock::serve
