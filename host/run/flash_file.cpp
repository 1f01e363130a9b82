#include "host/run/flash_file.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/flash/image_board.hpp"
#include "host/flash/uf2.hpp"
#include "host/run/image_path.hpp"
#include "host/run/simulated_boards.hpp"

namespace lamplock::run {
namespace {

/// EI_MAG0 to EI_MAG3 (System V Application Binary Interface, "ELF Identification").
constexpr std::string_view elf_magic =
    "\x7f"
    "ELF";

std::vector<flash::Part> parts_of(const sim::chip::Image& image) {
  std::vector<flash::Part> parts;
  parts.reserve(image.parts.size());
  for (const sim::chip::ImagePart& part : image.parts) parts.push_back({part.address, part.bytes});
  return parts;
}

}  // namespace

std::string board_of_image(const sim::chip::Image& image, const std::string& file) {
  return flash::board_of_image(flash::make_flash_image(parts_of(image), file));
}

FlashFile read_flash_file(const std::string& name, const std::string& board) {
  const std::string file =
      name.empty() ? image_path(name, uf2_name_of(board, "--for"), "flash") : name;
  const std::string bytes = read_file(file);
  std::vector<flash::Part> parts;
  if (flash::is_uf2(bytes)) {
    parts = flash::read_uf2(bytes, file);
  } else if (!bytes.starts_with(elf_magic)) {
    // A plain binary neither says where it belongs nor which chip it is for.
    refuse(file, "is neither a UF2 nor an ELF file", "give lamplock-rp2040.uf2 or .elf");
  } else {
    parts = parts_of(read_image(file));
  }
  flash::FlashImage image = flash::make_flash_image(std::move(parts), file);
  std::string of_board = flash::board_of_image(image);
  return {file, std::move(image), std::move(of_board)};
}

}  // namespace lamplock::run
