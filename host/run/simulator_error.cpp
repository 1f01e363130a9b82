#include "host/run/simulator_error.hpp"

#include "host/error.hpp"

namespace lamplock::run {

void refuse(const std::string& text) {
  const auto where = text.find(": ");
  const auto remedy = text.rfind("; ");
  if (where == std::string::npos || remedy == std::string::npos || remedy < where)
    throw Error(Exit::bad_input, "firmware image", text,
                "give an ELF, UF2 or BIN file for the RP2040");
  throw Error(Exit::bad_input, text.substr(0, where), text.substr(where + 2, remedy - where - 2),
              text.substr(remedy + 2));
}

}  // namespace lamplock::run
