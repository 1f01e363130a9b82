#include "host/cli/origin.hpp"

#include "host/cli/validators.hpp"
#include "host/run/origin.hpp"

namespace lamplock::cli {

void add_origin(Command& app, std::string& name) {
  app.add_option("--origin", &name,
                 "machine: points are in machine coordinates; zero: points are relative to the "
                 "zero stored on the board (lamplock operate zero)")
      .check(one_of({run::origin_machine, run::origin_zero}))
      .value_name("machine|zero")
      .show_default()
      .group("Board");
}

}  // namespace lamplock::cli
