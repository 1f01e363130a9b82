// The program `lamplock`.
#include "host/cli/program.hpp"
#include "host/cli/program_main.hpp"

int main(int argc, char** argv) {
  const auto program = lamplock::cli::make_program();
  return lamplock::cli::program_main(*program, argc, argv);
}
