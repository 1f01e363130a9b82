#include "host/run/simulated_boards.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/run/flash_file.hpp"
#include "host/run/image_path.hpp"
#include "host/run/simulator_error.hpp"
#include "shared/boards/all_boards.hpp"
#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::run {
namespace {

/// Boot takes about 0.08 s, enumeration as much again.
constexpr sim::Picoseconds max_boot_time = 2 * sim::ps_per_s;

/// The chip has the wiring of its settings, which would mislead the image of another board.
void require_board_of_image(const sim::chip::Image& image, const std::string& file,
                            const boards::BoardRow& wired, int pin_map) {
  const std::string name = board_of_image(image, file);
  const boards::BoardRow* const row = boards::find_board(std::string_view(name));
  if (row == nullptr || row == &wired) return;
  throw Error(Exit::bad_input, "--image",
              fmt::format("{} is for the board {}, and the simulated one is a {} (pin_map = {})",
                          file, name, wired.name, pin_map),
              fmt::format("give --machine with pin_map = {}", static_cast<int>(row->first_map)));
}

/// The chip's image: the file that was given, or that of this program.
std::string image_file(const std::string& image, int pin_map = 0) {
  return image_path(image, elf_name_of(pin_map), "--board chip");
}

}  // namespace

SimulatedBoard::SimulatedBoard() = default;
SimulatedBoard::~SimulatedBoard() = default;
SimulatedBoard::SimulatedBoard(SimulatedBoard&&) noexcept = default;
SimulatedBoard& SimulatedBoard::operator=(SimulatedBoard&&) noexcept = default;

sim::chip::Image read_image(const std::string& file) {
  check_is_file(file);
  try {
    return sim::chip::load_image(file);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

void check_image(const std::string& name, const std::string& image) {
  if (name == chip_board)
    read_image(image_file(image));
  else if (!image.empty())
    throw Error(Exit::bad_input, "--image", "only the chip runs an image", "add --board chip");
}

SimulatedBoard make_board(const std::string& name, const std::string& image,
                          const settings::Values& stored, const sim::WorldConfig& world,
                          sim::chip::UsbFunction function) {
  SimulatedBoard made;
  if (name == virtual_board) {
    made.board = std::make_unique<sim::VirtualBoard>(stored, world);
    return made;
  }
  const int pin_map = stored.whole(settings::Id::pin_map);
  const boards::BoardRow* const row = boards::find_board(static_cast<boards::PinMap>(pin_map));
  if (row == nullptr)
    throw Error(Exit::bad_input, "pin_map", fmt::format("no board has pin map {}", pin_map),
                "give one of docs/boards, or the virtual board");
  made.image = std::make_unique<sim::chip::Image>(read_image(image_file(image, pin_map)));
  require_board_of_image(*made.image, image_file(image, pin_map), *row, pin_map);
  std::unique_ptr<sim::ChipBoard> board;
  try {
    board = std::make_unique<sim::ChipBoard>(*made.image, stored, world);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
  made.timing = std::make_unique<sim::BoardTiming>(*board, *made.image);
  if (!board->run_until_found(max_boot_time))
    throw Error(Exit::no_device, image_file(image), "its USB port was not found within 2 s",
                "check that it is an image of lamplock");
  board->talk_over(function);
  made.board = std::move(board);
  return made;
}

}  // namespace lamplock::run
