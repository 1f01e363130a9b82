#include "host/serve/material_choice.hpp"

#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {

run::ProcessChoice material_choice(const nlohmann::json& parameters, const std::string& library) {
  run::ProcessChoice choice;
  const auto given = [&parameters]<class Value>(const char* name, std::optional<Value>& value) {
    if (const auto found = parameters.find(name); found != parameters.end())
      value = found->template get<Value>();
  };
  given("material", choice.material);
  given("laser", choice.laser);
  given("operation", choice.operation);
  given("thickness", choice.thickness_mm);
  if (choice.material)
    choice.library = library;
  else if (choice.laser || choice.operation || choice.thickness_mm)
    throw Error(Exit::bad_input, "material", "a part of the choice is given without the material",
                "give the material, or leave laser, operation and thickness out");
  return choice;
}

void refuse_for_jobs(const run::ProcessChoice& choice) {
  if (choice.material) throw Refusal(Exit::bad_input, "material-of-job");
}

}  // namespace lamplock::serve
