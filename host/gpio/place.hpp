// Where a line is: a name, or a chip and a number; and what is wrong when it is not there.
//
// In:  the text of a place, error numbers of the kernel. Out: its parts; errors with a remedy.
// Who: both bindings to libgpiod.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// A place taken apart: either the name alone, or chip and number.
struct Place {
  std::string name{};
  std::string chip{};  ///< file of the chip, "/dev/gpiochip0"
  unsigned number = 0;
};

/// Takes "GPIO17", "gpiochip0:17", "/dev/gpiochip0:17" apart. Throws Error(bad_input) for an empty
/// one.
Place parse_place(const std::string& text);

/// Files of all chips, by number. `folder`: of device files.
std::vector<std::string> chip_files(const std::string& folder = "/dev");

/// Why a chip could not be opened, with the remedy: "may not be opened; ...".
std::string chip_problem(const std::string& chip, int error);
/// For a chip that could not be opened.
Error chip_error(const std::string& chip, int error);
/// For a place that no chip has; `closed_chip`: one that could not be looked at, empty if all
/// could.
Error no_line_error(const std::string& place, const std::string& closed_chip = "");
/// A request with edges was refused because the chip has none: its driver has no interrupts
/// (gpiod_to_irq() in drivers/gpio/gpiolib.c: ENXIO; older kernels ENODEV, by way of the request
/// itself). Without edges it may be had.
bool has_no_edges(int error);
/// Looks for a line without asking for it: throws Error if no chip has it, or somebody uses it.
void check_free(const std::vector<ChipInfo>& chips, const std::string& place);

/// For a line that could not be had.
Error request_error(const std::string& place, int error);

}  // namespace lamplock::gpio
