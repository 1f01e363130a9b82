#include "host/serve/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/glass/volume.hpp"
#include "host/model/input.hpp"
#include "host/run/discretise.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/prepare.hpp"
#include "host/serve/quiet_frontend.hpp"

namespace lamplock::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using glass::Description;

/// Points that show an object while it is placed.
constexpr std::size_t max_preview = 20'000;
/// Side of a mesh in spacings of its preview.
constexpr double preview_spacings = 80;
constexpr std::size_t max_objects = 32;
constexpr double far_mm = 1e6;

/// Throws unless the file lies in the folder; the name is all that a client may give.
void require_own(const JobFolder& folder, const std::string& file, const std::string& where) {
  const fs::path path(file);
  if (path.parent_path() != folder.path())
    throw Error(Exit::bad_input, where, file + " is not in the folder of the server",
                "send it, and give its name without a folder");
  folder.path_of(path.filename().string());
}

/// Every place is allowed while an object is moved; only `fit` needs the volume.
glass::Volume lenient(const glass::Volume& volume, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), "fit") != words.end()) return volume;
  glass::Volume open = volume;
  open.block.reset();
  open.centre = volume.middle();
  open.reach = {{-far_mm, -far_mm, -far_mm}, {far_mm, far_mm, far_mm}};
  return open;
}

/// Fewer points of the same object: a mesh without its method, at a coarse spacing.
glass::Object preview_of(const glass::Object& object, const std::vector<std::string>& kept,
                         const glass::GlassChoice& glass, const glass::Volume& volume) {
  glass::Object preview = object;
  preview.transform = kept;
  if (!model::may_hold(object.file, model::InputKind::mesh)) return preview;
  preview = glass::Object{};
  preview.file = object.file;
  preview.up = object.up;
  preview.size_mm = object.size_mm;
  preview.transform = kept;
  const geometry::Bounds box = run::object_bounds(preview, glass, volume);
  const double side = box.max_side();
  if (side > 0) preview.spacing_mm = side / preview_spacings;
  return preview;
}

geometry::PointCloud thinned(geometry::PointCloud points) {
  const std::size_t step = points.size() / max_preview + 1;
  geometry::PointCloud few;
  for (std::size_t i = 0; i < points.size(); i += step) few.push_back(points[i]);
  return few;
}

double number_in(const Json& object, const char* key, double fallback) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return fallback;
  if (!found->is_number()) throw Error(Exit::bad_input, key, "is not a number", "give a number");
  return found->get<double>();
}

template <class Value>
void read_three(const Json& object, const char* key, std::array<Value, 3>& values) {
  const auto found = object.find(key);
  if (found == object.end()) return;
  const auto fits = [](const Json& each) {
    return std::is_same_v<Value, bool> ? each.is_boolean() : each.is_number();
  };
  if (!found->is_array() || found->size() != 3 || !std::all_of(found->begin(), found->end(), fits))
    throw Error(Exit::bad_input, key, "is not a list of three", "give one value for each axis");
  for (std::size_t i = 0; i < 3; ++i) values[i] = (*found)[i];
}

Placement placement_of(const Json& object) {
  Placement placement;
  read_three(object, "mirror", placement.mirror);
  placement.scale = number_in(object, "scale", 1);
  if (!(placement.scale >= 1e-6))
    throw Error(Exit::bad_input, "scale", "must be more than 0", "use mirror to mirror an object");
  read_three(object, "turn", placement.turn_deg);
  read_three(object, "move", placement.move_mm);
  return placement;
}

glass::Object object_of(const Json& given, const std::vector<glass::Object>& known,
                        const JobFolder& folder) {
  if (!given.is_object())
    throw Error(Exit::bad_input, "objects", "has an entry that is not an object",
                "see docs/api.md");
  glass::Object object;
  const Json from = given.value("object", Json());
  if (from.is_number_unsigned()) {
    if (from.get<std::size_t>() >= known.size())
      throw Error(Exit::bad_input, "object", "there is no such object", "open the scene again");
    object = known[from.get<std::size_t>()];
  } else {
    const Json file = given.value("file", Json());
    if (!file.is_string() || file.get_ref<const std::string&>().empty())
      throw Error(Exit::bad_input, "objects", "a new object has no file", "give its name");
    object.file = (folder.path() / file.get<std::string>()).string();
    require_own(folder, object.file, "objects");
  }
  if (const double size = number_in(given, "size", 0); size > 0) object.size_mm = size;
  std::vector<std::string> words = split_words(object.transform).kept;
  for (std::string& each : words_of(placement_of(given))) words.push_back(std::move(each));
  object.transform = std::move(words);
  return object;
}

}  // namespace

Description own_description(const JobFolder& folder, const std::string& name,
                            const std::string& profile) {
  const std::string path = folder.path_of(name).string();
  Description description;
  if (glass::is_description(path)) {
    description = glass::read_description(path);
  } else {
    description.objects.emplace_back();
    description.objects.front().file = path;
  }
  for (const glass::Object& object : description.objects) require_own(folder, object.file, name);
  if (description.machine.profile.empty())
    description.machine.profile = profile;
  else
    require_own(folder, description.machine.profile, name);
  return description;
}

Scene open_scene(const Description& description) {
  const settings::Values values = run::profile_of(description.machine).settings;
  const glass::Volume volume = glass::volume_of(description.glass, run::work_space_mm(values));
  Scene scene;
  if (volume.block) scene.block = volume.block->outside();
  scene.area = volume.reach;
  scene.middle = volume.middle();
  for (const glass::Object& object : description.objects) {
    SceneObject shown{fs::path(object.file).filename().string(), object.size_mm,
                      split_words(object.transform)};
    const std::vector<std::string>& kept = shown.words.kept;
    const glass::Volume open = lenient(volume, kept);
    QuietFrontend frontend;
    run::ObjectPoints made = run::object_points(preview_of(object, kept, description.glass, open),
                                                description.glass, open, frontend);
    shown.cloud = std::make_shared<const Cloud>(thinned(std::move(made.points)));
    scene.objects.push_back(std::move(shown));
  }
  return scene;
}

void place_objects(const JobFolder& folder, Description& description, const Json& objects,
                   const Json& block) {
  if (!objects.is_array() || objects.empty() || objects.size() > max_objects)
    throw Error(Exit::bad_input, "objects", "is not a list of objects",
                fmt::format("give 1 to {}", max_objects));
  std::vector<glass::Object> placed;
  for (const Json& given : objects) placed.push_back(object_of(given, description.objects, folder));
  description.objects = std::move(placed);
  if (!block.is_array()) return;
  glass::Triple size{};
  for (std::size_t i = 0; i < 3; ++i) size[i] = block[i];
  description.glass.block_mm = size;
}

void write_scene(const JobFolder& folder, const std::string& name, const Description& description) {
  if (!glass::is_description(name))
    throw Error(Exit::bad_input, name, "is not the name of a description", "name it .toml");
  folder.check_name(name);
  const fs::path target = folder.path() / name;
  Description own = description;
  if (fs::path(own.machine.profile).parent_path() != folder.path()) own.machine.profile.clear();
  const settings::Values values = run::profile_of(description.machine).settings;
  glass::volume_of(own.glass, run::work_space_mm(values));  // refuses a block that does not fit
  write_whole(target, [&](const fs::path& path) {
    write_file(path, glass::to_text(own, folder.path()));
    glass::read_description(path);
  });
}

}  // namespace lamplock::serve
