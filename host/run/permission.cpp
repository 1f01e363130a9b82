#include "host/run/permission.hpp"

#include "host/error.hpp"
#include "host/run/board_port.hpp"

namespace lamplock::run {

void require_askable(const BoardOptions& options, const Frontend& frontend) {
  if (options.is_simulated() || options.dry || options.yes || frontend.can_ask()) return;
  check_is_connected(options);  // else the remedy would lead to the next error
  throw Error(Exit::bad_input, "--board " + options.board,
              "firing needs confirmation, and there is no terminal",
              "run it in a terminal, or add --yes or --dry");
}

void require_permission(const BoardOptions& options, Frontend& frontend,
                        const std::string& question, const std::string& where,
                        const std::string& denied) {
  if (options.yes || options.is_simulated() || frontend.confirms(question)) return;
  throw Error(Exit::interrupted, where, "not permitted, " + denied, "answer yes, or give --yes");
}

}  // namespace lamplock::run
