// `lamplock material`: the library of lasers, materials, settings and test cuts.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "host/cli/command_line.hpp"
#include "host/cli/command_material.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/material_text.hpp"
#include "host/cli/validators.hpp"
#include "host/material/fields.hpp"
#include "host/number_text.hpp"
#include "host/run/material_records.hpp"

namespace lamplock::cli {
namespace {

struct RecordOptions {
  run::RecordChoice choice;
  std::vector<std::string> words;
  std::string file;
  bool json = false, replaces = false;
};

/// Prints the records of one kind; returns them as JSON.
template <class Record>
Json list_json(const std::vector<Record>& records, Console& console) {
  Json list = Json::array();
  for (const Record& record : records) {
    std::string line = line_of(record);
    line.erase(line.find_last_not_of(' ') + 1);
    console.line(line);
    list.push_back(record_json(record));
  }
  return list;
}

Exit list(const RecordOptions& options) {
  Console console(options.json);
  material::Library library = run::library_for_reading(options.choice.library);
  const Json document = run::with_kind(options.choice.kind, [&](const auto& empty) {
    return list_json(library.all<std::decay_t<decltype(empty)>>(), console);
  });
  if (document.empty()) console.say("the library has no {}", options.choice.kind);
  console.document(document);
  return Exit::done;
}

/// All fields that have a value, one a line.
template <class Record>
void say_fields(Console& console, Record record) {
  for (const material::Field& field : fields(record))
    if (!is_absent(field)) console.say("{:<22}{}", field.key, value_text(field));
}

Exit show(const RecordOptions& options) {
  Console console(options.json);
  material::Library library = run::library_for_reading(options.choice.library);
  if (run::record_kind_named(options.choice.kind) == run::RecordKind::laser) {
    const material::Laser laser = library.laser(options.choice.name);
    say_fields(console, laser);
    console.document(record_json(laser));
    return Exit::done;
  }
  const material::Material one = library.material(options.choice.name);
  say_fields(console, one);
  Json document = record_json(one);
  const auto settings = library.settings_of(one.name);
  if (!settings.empty()) console.line("settings");
  document["settings"] = list_json(settings, console);
  const auto measurements = library.measurements_of(one.name);
  if (!measurements.empty()) console.line("measurements");
  document["measurements"] = list_json(measurements, console);
  console.document(document);
  return Exit::done;
}

Exit add_one(const RecordOptions& options) {
  Console console(options.json);
  const std::string title = run::add_record(options.choice, options.words);
  console.say("added {}", title);
  return Exit::done;
}

Exit edit(const RecordOptions& options) {
  Console console(options.json);
  const std::string title = run::edit_record(options.choice, options.words);
  console.say("changed {}", title);
  return Exit::done;
}

Exit remove_one(const RecordOptions& options) {
  Console console(options.json);
  const run::RemovedRecord removed = run::remove_record(options.choice);
  console.say(
      "removed {}{}", removed.title,
      removed.settings + removed.measurements == 0
          ? ""
          : fmt::format(" with {} and {}", lamplock::count_text(removed.settings, "setting"),
                        lamplock::count_text(removed.measurements, "measurement")));
  return Exit::done;
}

Exit import_file(const RecordOptions& options) {
  Console console(options.json);
  const material::ImportCount count =
      run::import_records(options.choice.library, options.file, options.replaces);
  console.say("{}: {} added, {} replaced, {} unchanged", options.file, count.added, count.replaced,
              count.unchanged);
  console.document(
      {{"added", count.added}, {"replaced", count.replaced}, {"unchanged", count.unchanged}});
  return Exit::done;
}

Exit export_file(const RecordOptions& options) {
  Console console(options.json);
  const material::Records records = run::exported_records(options.choice.library, options.words);
  run::write_records(records, options.file);
  console.say("{}: {}, {}, {}, {}", options.file,
              lamplock::count_text(records.lasers.size(), "laser"),
              lamplock::count_text(records.materials.size(), "material"),
              lamplock::count_text(records.settings.size(), "setting"),
              lamplock::count_text(records.measurements.size(), "measurement"));
  console.document({{"file", options.file},
                    {"lasers", records.lasers.size()},
                    {"materials", records.materials.size()},
                    {"settings", records.settings.size()},
                    {"measurements", records.measurements.size()}});
  return Exit::done;
}

using Options = std::shared_ptr<RecordOptions>;

Command& add(Command& app, const Options& options, const std::string& name, const std::string& what,
             const std::string& footer, Exit (*action)(const RecordOptions&)) {
  Command& sub = app.add_command(name, what);
  sub.footer(footer);
  sub.action([options, action] { return action(*options); });
  return sub;
}

void add_name(Command& sub, RecordOptions& options, const char* help) {
  sub.add_option("NAME", &options.choice.name, help).required();
}

void add_kind(Command& sub, RecordOptions& options) {
  sub.add_option("--kind", &options.choice.kind, "Kind of record")
      .value_name("material|laser|setting|measurement")
      .check(one_of(run::record_kind_names()))
      .show_default();
}

void add_number(Command& sub, RecordOptions& options) {
  sub.add_option("--number", &options.choice.number,
                 "Number of the setting or measurement, as show prints it")
      .check(number_in({1, 1'000'000'000}))
      .value_name("N");
}

/// The fields of all kinds, for shells.
std::vector<std::string> fields_with_equals() {
  std::vector<std::string> all;
  const auto add_keys = [&all](auto record) {
    for (const std::string& key : keys_of(fields(record)))
      if (std::ranges::find(all, key + "=") == all.end()) all.push_back(key + "=");
  };
  add_keys(material::Material{});
  add_keys(material::Laser{});
  add_keys(material::Setting{});
  add_keys(material::Measurement{});
  return all;
}

/// "Fields of a laser: name, power_w, ..."
template <class Record>
std::string fields_text(Record record) {
  return fmt::format("Fields of a {}: {}.\n", material::kind_of<Record>(),
                     fmt::join(keys_of(fields(record)), ", "));
}

std::string all_fields_text() {
  return fields_text(material::Material{}) + fields_text(material::Laser{}) +
         fields_text(material::Setting{}) + fields_text(material::Measurement{});
}

void add_views(Command& app, const Options& options) {
  Command& list_command = add(app, options, "list", "List the records of one kind",
                              "Example:\n  lamplock material list\n"
                              "  lamplock material list --kind laser --json",
                              list);
  add_kind(list_command, *options);
  list_command.add_json(options->json);
  add_library(list_command, options->choice.library);
  Command& show_command =
      add(app, options, "show", "Show a material with its settings and measurements, or a laser",
          "Example:\n  lamplock material show plywood\n"
          "  lamplock material show diode-3w --kind laser",
          show);
  add_name(show_command, *options, "Name of the material or laser");
  show_command.add_option("--kind", &options->choice.kind, "Kind of record")
      .value_name("material|laser")
      .check(one_of({"material", "laser"}))
      .show_default();
  show_command.add_json(options->json);
  add_library(show_command, options->choice.library);
}

void add_changes(Command& app, const Options& options) {
  const char* const name_help =
      "Name of the material or laser; of a setting or measurement the name of its material";
  Command& add_command = add(app, options, "add", "Add a record",
                             all_fields_text() +
                                 "Example:\n"
                                 "  lamplock material add oak density_g_cm3=0.7 "
                                 "specific_energy_kj_g=1 absorption=1\n"
                                 "  lamplock material add diode-10w --kind laser power_w=10 "
                                 "beam_width_mm=0.1\n"
                                 "  lamplock material add plywood --kind setting laser=diode-3w "
                                 "thickness_mm=3 feed_mm_min=180 power_w=3 passes=4",
                             add_one);
  add_name(add_command, *options, name_help);
  add_command.add_option("CHANGE", &options->words, "FIELD=VALUE")
      .completions(fields_with_equals());
  add_kind(add_command, *options);
  add_library(add_command, options->choice.library);
  Command& edit_command =
      add(app, options, "edit", "Change fields of a record; FIELD= removes a value",
          all_fields_text() +
              "Example:\n"
              "  lamplock material edit plywood thickness_mm=3\n"
              "  lamplock material edit plywood --kind measurement --number 13 rejected=true",
          edit);
  add_name(edit_command, *options, name_help);
  edit_command.add_option("CHANGE", &options->words, "FIELD=VALUE")
      .required()
      .completions(fields_with_equals());
  add_kind(edit_command, *options);
  add_number(edit_command, *options);
  add_library(edit_command, options->choice.library);
  Command& remove_command =
      add(app, options, "remove", "Remove a record; a material with its settings and measurements",
          "Example:\n  lamplock material remove rubber\n"
          "  lamplock material remove plywood --kind measurement --number 13",
          remove_one);
  add_name(remove_command, *options, name_help);
  add_kind(remove_command, *options);
  add_number(remove_command, *options);
  add_library(remove_command, options->choice.library);
}

void add_exchange(Command& app, const Options& options) {
  Command& import_command = add(
      app, options, "import", "Add the records of a file (TOML)",
      "Equal records are kept as they are. A record whose name, or for a setting whose laser,\n"
      "material, thickness and operation exist with other values, is refused without --replace;\n"
      "then nothing is imported.\n"
      "Example:\n  lamplock material import workshop.toml",
      import_file);
  import_command.add_option("FILE", &options->file, "File of records to read")
      .required()
      .file(FileUse::read);
  import_command.add_option("--replace", &options->replaces,
                            "Replace records of the library that differ");
  import_command.add_json(options->json);
  add_library(import_command, options->choice.library);
  Command& export_command = add(app, options, "export", "Write records to a file (TOML)",
                                "Example:\n  lamplock material export workshop.toml\n"
                                "  lamplock material export plywood.toml --material plywood",
                                export_file);
  export_command.add_option("FILE", &options->file, "File to write")
      .required()
      .file(FileUse::write, ".toml");
  export_command
      .add_option("--material", &options->words,
                  "Write this material and its lasers only; may be given several times")
      .value_name("NAME");
  export_command.add_json(options->json);
  add_library(export_command, options->choice.library);
}

}  // namespace

void add_library(Command& app, std::string& library) {
  app.add_option("--library", &library,
                 "File of the material library; default: lamplock/library.db in XDG_DATA_HOME")
      .value_name("FILE")
      .file(FileUse::write);
}

void add_material(Command& program) {
  Command& app = program.add_command(
      "material", "Material library: lasers, materials, settings, test cuts and their evaluation");
  app.footer(
      "docs/materials.md is the guide. A library that does not exist yet has the records that\n"
      "lamplock delivers: a diode laser of 3 W and eleven materials with their published test "
      "cuts.\n"
      "Example:\n"
      "  lamplock material list\n"
      "  lamplock material measure plywood --feed 180 --power 3 --depth 0.8\n"
      "  lamplock material fit plywood\n"
      "  lamplock material best plywood --thickness 5");
  const auto options = std::make_shared<RecordOptions>();
  add_views(app, options);
  add_changes(app, options);
  add_exchange(app, options);
  add_material_cuts(app);
  add_material_card(app);
}

}  // namespace lamplock::cli
