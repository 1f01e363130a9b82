// Simulated boards by name, and the flash image the chip runs.
//
// In:  "virtual" or "chip", an image file or nothing. Out: a board that a host can talk to.
// Who: jobs on simulated boards, `sim`.
#pragma once

#include <memory>
#include <string>

#include "shared/settings_table.hpp"
#include "sim/board.hpp"
#include "sim/chip/image/image.hpp"
#include "sim/chip/usb_host/usb_function.hpp"

namespace lamplock::sim {
class BoardTiming;
struct WorldConfig;
}  // namespace lamplock::sim

namespace lamplock::run {

/// Names of the boards that are simulated.
inline constexpr const char* virtual_board = "virtual";
inline constexpr const char* chip_board = "chip";

/// A board in this process. `timing` is there for the chip alone.
struct SimulatedBoard {
  SimulatedBoard();
  ~SimulatedBoard();
  SimulatedBoard(SimulatedBoard&&) noexcept;
  SimulatedBoard& operator=(SimulatedBoard&&) noexcept;

  std::unique_ptr<sim::chip::Image> image;
  std::unique_ptr<sim::Board> board;
  std::unique_ptr<sim::BoardTiming> timing;
};

/// Makes a board that keeps these settings and has been found by its host. `image`: file for the
/// chip; empty: the one that came with the program (image_path.hpp). Throws Error(bad_input) for an
/// image that cannot be used, Error(no_device) if the board does not come up. `function`: what the
/// chip is talked to over.
SimulatedBoard make_board(const std::string& name, const std::string& image,
                          const settings::Values& stored, const sim::WorldConfig& world,
                          sim::chip::UsbFunction function = sim::chip::UsbFunction::serial);

/// Reads a flash image. Throws Error(bad_input).
sim::chip::Image read_image(const std::string& file);

/// Checks before any work that the image is there and is one. Throws Error(bad_input).
void check_image(const std::string& name, const std::string& image);

}  // namespace lamplock::run
