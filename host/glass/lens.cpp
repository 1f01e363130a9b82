#include "host/glass/lens.hpp"

#include <fmt/format.h>

#include <array>

#include "host/error.hpp"
#include "host/suggestion.hpp"

namespace lamplock::glass {
namespace {

// Welding distances of "Mechatronic positioning of a pulsed laser beam in devices forming 3-D
// objects in glass".
constexpr std::array known{Lens{"f43", 0.09}, Lens{"f70", 0.13}};

}  // namespace

std::vector<std::string> lens_names() {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const Lens& lens : known) names.emplace_back(lens.name);
  return names;
}

const Lens& lens_named(const std::string& name) {
  for (const Lens& lens : known)
    if (lens.name == name) return lens;
  throw Error(Exit::bad_input, "lens", fmt::format("'{}' is not known", name),
              did_you_mean(name, lens_names(), "use f43 or f70"));
}

}  // namespace lamplock::glass
