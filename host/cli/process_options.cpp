#include "host/cli/process_options.hpp"

#include "host/cli/validators.hpp"

namespace lamplock::cli {

void add_process(Command& app, run::ProcessChoice& choice) {
  const std::string group = "Material of a program";
  app.add_option("--material", &choice.material,
                 "Material of the library (lamplock material): the program reads its values as "
                 "#<_material_feed>, #<_material_power> and so on")
      .value_name("NAME")
      .group(group);
  app.add_option("--laser", &choice.laser,
                 "Laser of the library; default: the only one with a setting for the operation")
      .value_name("NAME")
      .group(group);
  app.add_option("--thickness", &choice.thickness_mm,
                 "Thickness of the material; default: that in the library")
      .value_name("MM")
      .check(number_in(glass::positive))
      .group(group);
  app.add_option("--operation", &choice.operation,
                 "Operation of the setting: cut, score or engrave; default: cut")
      .value_name("NAME")
      .check(one_of({"cut", "score", "engrave"}))
      .group(group);
  app.add_option("--library", &choice.library,
                 "Material library; default: that of lamplock material")
      .value_name("FILE")
      .file(FileUse::read)
      .group(group);
}

void add_user_commands(Command& app, std::string& folder) {
  app.add_option("--user-commands", &folder,
                 "Permit M100 to M199: at rest, the host runs the program of this name in the "
                 "folder with P and Q as arguments")
      .value_name("FOLDER")
      .file(FileUse::folder)
      .group("Board");
}

}  // namespace lamplock::cli
