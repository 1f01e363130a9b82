#include "host/run/image_path.hpp"

#include <fmt/format.h>
#include <sys/auxv.h>

#include <filesystem>
#include <span>
#include <system_error>
#include <vector>

#include "host/error.hpp"
#include "host/suggestion.hpp"
#include "shared/boards/all_boards.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

/// From the folder of the program: a build, an installation.
constexpr const char* folders[] = {".", "../share/lamplock"};
constexpr const char* document_folders[] = {"../share/doc/lamplock"};

/// This program's file; empty if the system does not report it.
fs::path own_file() {
  std::error_code failed;
  fs::path link = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) return link;
  // No /proc, as in a bare chroot: the name that the kernel was given (getauxval(3)).
  // NOLINTNEXTLINE(performance-no-int-to-ptr): getauxval() returns the address as a number
  const auto* name = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
  return name == nullptr ? fs::path() : fs::path(name);
}

/// The first of these folders, given from that of the program, that has the file.
std::string find_file(const fs::path& program, std::span<const char* const> folders_there,
                      const std::string& name) {
  std::error_code failed;
  const fs::path folder = fs::canonical(program, failed).parent_path();
  if (failed) return {};
  for (const char* const there : folders_there) {
    const fs::path file = (folder / there / name).lexically_normal();
    if (fs::is_regular_file(file, failed)) return file.string();
  }
  return {};
}

}  // namespace

std::string file_of_program_at(const std::string& program, const std::string& name) {
  return find_file(program, folders, name);
}

std::string document_of_program(const std::string& name) {
  return find_file(own_file(), document_folders, name);
}

std::string file_of_program(const std::string& name) {
  return file_of_program_at(own_file().string(), name);
}

std::string board_names() {
  std::string names;
  for (const boards::BoardRow* row : boards::all_boards)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", row->name);
  return names;
}

std::string uf2_name_of(const std::string& board, const std::string& where) {
  if (const boards::BoardRow* row = boards::find_board(board))
    return fmt::format("{}.uf2", row->image);
  std::vector<std::string> names;
  for (const boards::BoardRow* row : boards::all_boards) names.emplace_back(row->name);
  throw Error(Exit::bad_input, where,
              board.empty() ? std::string("the board is not named")
                            : fmt::format("there is no board '{}'", board),
              did_you_mean(board, names, fmt::format("use one of: {}", board_names())));
}

std::string elf_name_of(int pin_map) {
  const boards::BoardRow* row = boards::find_board(static_cast<boards::PinMap>(pin_map));
  return fmt::format("{}.elf", (row == nullptr ? boards::pico : *row).image);
}

std::string image_path(const std::string& given, const std::string& name,
                       const std::string& where) {
  if (!given.empty()) return given;
  if (std::string file = file_of_program(name); !file.empty()) return file;
  throw Error(Exit::bad_input, where,
              fmt::format("there is no {} beside the program or in ../share/lamplock", name),
              "build the firmware, or give its file");
}

}  // namespace lamplock::run
