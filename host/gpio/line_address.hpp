// Address of a line, a name or a chip and a number, and errors for lines that cannot be used.
//
// In:  the text of an address, error numbers of the kernel. Out: its parts; errors with a remedy.
// Who: both bindings to libgpiod.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// A parsed address: either the name alone, or chip and number.
struct LineAddress {
  std::string name{};
  std::string chip{};  ///< file of the chip, "/dev/gpiochip0"
  unsigned number = 0;
};

/// Parses "GPIO17", "gpiochip0:17", "/dev/gpiochip0:17". Throws Error(bad_input) for an empty text.
LineAddress parse_line_address(const std::string& text);

/// Files of all chips, by number. `folder`: of device files.
std::vector<std::string> chip_files(const std::string& folder = "/dev");

/// Why a chip cannot be opened, with the remedy: "no permission to open it; ...".
std::string chip_problem(const std::string& chip, int error);
/// Error for a chip that cannot be opened.
Error chip_error(const std::string& chip, int error);
/// Error for a place that no chip has; `closed_chip`: one that cannot be opened, empty if all can.
Error no_line_error(const std::string& place, const std::string& closed_chip = "");
/// A request with edges was refused because the chip has none: its driver has no interrupts
/// (gpiod_to_irq() in drivers/gpio/gpiolib.c: ENXIO; older kernels ENODEV, by way of the request
/// itself). A request without edges may succeed.
bool has_no_edges(int error);
/// Finds a line without a request: throws Error if no chip has it, or it is in use.
void check_free(const std::vector<ChipInfo>& chips, const std::string& place);

/// Error for a refused request.
Error request_error(const std::string& place, int error);

}  // namespace lamplock::gpio
