// Names of the wires as they appear in traces.
#pragma once

#include <array>
#include <string_view>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

inline constexpr std::array<std::string_view, pin_count> pin_names{
    "step_x",        "dir_x",         "step_y",        "dir_y",         "step_z",    "dir_z",
    "step_a",        "dir_a",         "lamp_sync",     "lamp_trigger",  "q_switch",  "laser_gate",
    "arm",           "enable",        "estop",         "door",          "limit_x",   "limit_y",
    "limit_z",       "limit_a",       "shutter_1",     "shutter_2",     "shutter_3", "shutter_4",
    "photosensor_1", "photosensor_2", "photosensor_3", "photosensor_4", "probe",     "enable_z",
    "air",           "aux_out",       "aux_in"};

}  // namespace lamplock::sim
