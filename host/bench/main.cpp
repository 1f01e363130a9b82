// The program `lamplock-bench`, which `lamplock bench` starts.
#include "host/bench/command_bench.hpp"
#include "host/cli/program.hpp"
#include "host/cli/program_main.hpp"

int main(int argc, char** argv) {
  const auto program = lamplock::cli::make_empty_program();
  lamplock::bench::add_bench(*program);
  return lamplock::cli::program_main(*program, argc, argv);
}
