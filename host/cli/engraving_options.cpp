#include "host/cli/engraving_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "host/cli/command_line.hpp"
#include "host/cli/parameter_options.hpp"
#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/model/input.hpp"
#include "host/run/origin.hpp"

namespace lamplock::cli {
namespace {

std::string input_help() {
  using model::extensions;
  using model::InputKind;
  return fmt::format(
      "Mesh ({}), drawing ({}), bitmap ({}), point list ({}) or job description (toml)",
      extensions(InputKind::mesh), extensions(InputKind::curves), extensions(InputKind::bitmap),
      extensions(InputKind::points));
}

}  // namespace

void EngravingOptions::add_section(Command& app, const std::vector<glass::Parameter>& parameters,
                                   const std::string& group) {
  // Those that most jobs need; the others refine them.
  constexpr std::array common{"--size",  "--spacing", "--method", "--material",
                              "--order", "--machine", "--flashes"};
  for (Option* option : add_parameters(app, parameters, group)) {
    if (std::find(common.begin(), common.end(), option->name()) != common.end()) option->common();
    options_.push_back(option);
  }
}

void EngravingOptions::add_place(Command& app, bool input_required) {
  app.add_option("INPUT", &input, input_help())
      .required(input_required)
      .value_name("FILE")
      .file(FileUse::read);
  std::vector<glass::Parameter> object = glass::parameters(said_.objects.front());
  object.erase(object.begin());  // the file is INPUT
  add_section(app, object, "Points");
  add_section(app, glass::parameters(said_.glass), "Glass");
  std::vector<glass::Parameter> machine = glass::parameters(said_.machine);
  machine.resize(1);  // the profile
  add_section(app, machine, "Machine");
}

void EngravingOptions::add(Command& app, bool input_required) {
  add_place(app, input_required);
  std::vector<glass::Parameter> machine = glass::parameters(said_.machine);
  machine.erase(machine.begin());  // the profile is there
  add_section(app, machine, "Machine");
  add_section(app, glass::parameters(said_.order), "Order");
  add_section(app, glass::parameters(said_.pause), "Pauses");
  add_section(app, glass::parameters(said_.output), "Output");
}

void EngravingOptions::add_save(Command& app) {
  app.add_option("--save", &save_,
                 "Save the options of this command as a job description, to run it again")
      .value_name("FILE.toml")
      .file(FileUse::write)
      .common();
}

glass::Description EngravingOptions::description() const {
  if (!glass::is_description(input)) {
    glass::Description description = said_;
    description.objects.front().file = input;
    return description;
  }
  refuse_options("has its place in the description", "leave it out and change " + input);
  return glass::read_description(input);
}

void EngravingOptions::refuse_options(const std::string& why, const std::string& remedy) const {
  for (const Option* option : options_)
    if (option->is_given()) throw Error(Exit::bad_input, option->name(), why, remedy);
}

void EngravingOptions::check_save() const {
  if (save_.empty()) return;
  if (!glass::is_description(save_))
    throw Error(Exit::bad_input, save_, "is not the name of a description", "name it .toml");
  check_target(save_);
}

run::JobRequest EngravingOptions::request() const {
  check_save();
  return {input, description(), save_, run::origin_machine};
}

}  // namespace lamplock::cli
