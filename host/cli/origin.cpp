#include "host/cli/origin.hpp"

#include "host/cli/command_line.hpp"
#include "host/cli/validators.hpp"
#include "host/link/operator.hpp"

namespace lamplock::cli {

void OriginOption::add(Command& app) {
  app.add_option(
         "--origin", &name,
         "machine: points are in the machine's coordinates; zero: in those of the zero that "
         "was taught to the board (lamplock operate zero)")
      .check(one_of({"machine", "zero"}))
      .value_name("machine|zero")
      .show_default()
      .group("Board");
}

std::optional<points::Point> OriginOption::ask(link::Transport* port) const {
  if (name == "machine") return std::nullopt;
  if (port == nullptr) return points::Point{};
  link::LinePort lines(*port);
  const link::Places places = link::ask_places(lines);
  link::require_unshifted(places);
  const auto axis = [&places](std::size_t a) {
    return a < places.zero.size() ? places.zero[a] : 0;
  };
  return points::Point{axis(0), axis(1), axis(2)};
}

}  // namespace lamplock::cli
