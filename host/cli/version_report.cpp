#include "host/cli/version_report.hpp"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/cli/console.hpp"
#include "host/cli/json.hpp"
#include "host/run/image_path.hpp"
#include "host/version.hpp"
#include "shared/wire/messages.hpp"

namespace lamplock::cli {
namespace {

constexpr const char* board_name = "rp2040";

/// Paths of the images that came with the program.
std::vector<std::string> images() {
  std::vector<std::string> found;
  for (const char* const name : {run::elf_image_name, run::uf2_image_name})
    if (std::string file = run::file_of_program(name); !file.empty()) found.push_back(file);
  return found;
}

Json as_json() {
  Json versions = Json::object();
  for (const Library& library : libraries()) versions[std::string(library.name)] = library.version;
  Json boards = Json::array();
  if (const auto files = images(); !files.empty())
    boards.push_back({{"name", board_name}, {"images", files}});
  return {{"version", version()},  {"compiler", compiler()},
          {"build", build_type()}, {"protocol", wire::protocol_version},
          {"boards", boards},      {"libraries", versions}};
}

void say(Console& console, const std::string& name, const std::string& text) {
  console.say("{:<9} {}", name, text);
}

void say_build(Console& console) {
  say(console, "compiler", fmt::format("{}, {}", compiler(), build_type()));
  say(console, "protocol", fmt::format("{}", wire::protocol_version));
  const std::vector<std::string> files = images();
  if (files.empty()) say(console, "board", fmt::format("{}: no image found", board_name));
  for (const std::string& file : files)
    say(console, "board", fmt::format("{}: {}", board_name, file));
  for (const Library& library : libraries())
    say(console, "library", fmt::format("{} {}", library.name, library.version));
}

Exit report_version(bool is_verbose, bool json) {
  Console console(json);
  if (json) {
    console.document(as_json());
    return Exit::done;
  }
  console.say("lamplock {}", version());
  if (is_verbose) say_build(console);
  return Exit::done;
}

}  // namespace

void add_version_report(Command& program) {
  struct Flags {
    bool verbose = false, json = false;
  };
  // --version ends the parsing before flags have their values.
  const auto flags = std::make_shared<Flags>();
  const Option& verbose =
      program
          .add_option("--verbose", &flags->verbose,
                      "With --version: print compiler, libraries, protocol and flash images, too")
          .for_version();
  const Option& json =
      program.add_json(flags->json, "With --version: print all that as JSON on stdout")
          .for_version();
  program.version_action(
      [flags, &verbose, &json] { return report_version(verbose.is_given(), json.is_given()); });
}

}  // namespace lamplock::cli
