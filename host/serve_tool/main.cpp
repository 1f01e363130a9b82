// The program `lamplock-serve`, which `lamplock serve` and `lamplock watch` start.
#include "host/cli/program.hpp"
#include "host/cli/program_main.hpp"
#include "host/serve_tool/commands.hpp"

int main(int argc, char** argv) {
  const auto program = lamplock::cli::make_empty_program();
  lamplock::serve_tool::add_serve(*program);
  lamplock::serve_tool::add_watch(*program);
  return lamplock::cli::program_main(*program, argc, argv);
}
