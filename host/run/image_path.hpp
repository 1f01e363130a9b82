// Where the flash image is that came with this program.
//
// In:  the name of a file. Out: its path: beside the program, as in a build, or in
//      ../share/lamplock, where an installation puts it.
// Who: the chip simulator (`--board chip`, `chip`), flashing.
#pragma once

#include <string>

namespace lamplock::run {

/// The flash image of the RP2040: with symbols, as the chip simulator runs it; as it is flashed.
inline constexpr const char* elf_image_name = "lamplock-rp2040.elf";
inline constexpr const char* uf2_image_name = "lamplock-rp2040.uf2";

/// Names of all boards: "pico, ...".
std::string board_names();
/// The UF2 file of a board (shared/boards/all_boards.hpp). Throws Error(bad_input) if no board has
/// that name, or if `board` is empty: the board is asked for, never guessed. `where`: the option.
std::string uf2_name_of(const std::string& board, const std::string& where);
/// The ELF file for the board that has a pin map ($990).
std::string elf_name_of(int pin_map);

/// Path of a file that came with the program; empty if there is none. Links to the program are
/// followed.
std::string file_of_program(const std::string& name);

/// The same for a program that lies there; empty if there is none.
std::string file_of_program_at(const std::string& program, const std::string& name);

/// `given` if it is not empty, else the image of that name that came with the program. `where`
/// names the option in the Error(bad_input) that is thrown if there is none.
std::string image_path(const std::string& given, const std::string& name, const std::string& where);

/// A guide or example that was installed with this program; empty if there is none.
std::string document_of_program(const std::string& name);

}  // namespace lamplock::run
