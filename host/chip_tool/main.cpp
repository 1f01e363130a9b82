// The program `lamplock-chip`, which `lamplock chip` starts.
#include "host/chip_tool/command_chip.hpp"
#include "host/cli/program.hpp"
#include "host/cli/program_main.hpp"

int main(int argc, char** argv) {
  const auto program = lamplock::cli::make_empty_program();
  lamplock::chip_tool::add_chip(*program);
  return lamplock::cli::program_main(*program, argc, argv);
}
