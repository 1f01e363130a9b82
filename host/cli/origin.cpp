#include "host/cli/origin.hpp"

#include "host/cli/validators.hpp"
#include "host/link/operator.hpp"

namespace lamplock::cli {

void OriginOption::add(CLI::App& app) {
  app.add_option(
         "--origin", name,
         "machine: points are in the machine's coordinates; zero: in those of the zero that "
         "was taught to the board (lamplock operate zero)")
      ->check(one_of({"machine", "zero"}))
      ->type_name("machine|zero")
      ->capture_default_str()
      ->group("Board");
}

points::Point OriginOption::ask(link::Transport* port) const {
  if (name == "machine" || port == nullptr) return {};
  link::LinePort lines(*port);
  const std::vector<double> zero = link::ask_places(lines).zero;
  const auto axis = [&zero](std::size_t a) { return a < zero.size() ? zero[a] : 0; };
  return {axis(0), axis(1), axis(2)};
}

}  // namespace lamplock::cli
