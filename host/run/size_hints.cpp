#include "host/run/size_hints.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/file.hpp"
#include "host/number_text.hpp"
#include "host/run/placed_model.hpp"

namespace lamplock::run {
namespace {

using model::InputKind;

/// Smaller objects and clouds are rarely what the user has in mind.
constexpr double min_usual_side_mm = 5;
constexpr std::size_t min_usual_points = 500;
/// A size for the question: that of a usual block.
constexpr int usual_size_mm = 40;
/// Height of a flat-lying model, as a share of its depth.
constexpr double max_flat_share = 0.5;

/// The size of a bitmap is the user's or the default, never that of the file.
bool has_size_of_file(const glass::Object& object, InputKind kind) {
  return (kind == InputKind::mesh || kind == InputKind::curves) && !object.size_mm;
}

/// These formats define which axis points up.
bool defines_up(const std::string& file) {
  const std::string extension = lower_extension(file);
  return extension == ".glb" || extension == ".3mf";
}

/// These mesh formats have a unit; drawings have one, or are refused without --units.
bool defines_unit(const std::string& file) { return defines_up(file); }

bool is_upright_by_choice(const glass::Object& object) {
  const auto turns = [](const std::string& step) { return step.find("rotate") != step.npos; };
  return object.up != "z" || defines_up(object.file) ||
         std::any_of(object.transform.begin(), object.transform.end(), turns);
}

}  // namespace

std::vector<std::string> size_hints(const glass::Object& object, InputKind kind,
                                    const geometry::Bounds& box, std::size_t points) {
  std::vector<std::string> hints;
  const double x = box.high.x - box.low.x, y = box.high.y - box.low.y, z = box.high.z - box.low.z;
  if (has_size_of_file(object, kind)) {
    const bool has_unit = kind == InputKind::curves || defines_unit(object.file);
    const double max_side_mm = std::max({x, y, z});
    const bool has_few_points = points < min_usual_points;
    if (max_side_mm < min_usual_side_mm ||
        (has_few_points && !has_unit && max_side_mm < usual_size_mm))
      hints.push_back(fmt::format("{} is {} and has {}: {} --size {} makes its longest side {} mm",
                                  object.file, size_text(box), count_text(points, "point"),
                                  has_unit ? "is it meant to be so small?" : "is the file in mm?",
                                  usual_size_mm, usual_size_mm));
    else if (has_few_points)
      hints.push_back(
          fmt::format("{} is {} and has {}: a smaller --spacing gives more, --size another size",
                      object.file, size_text(box), count_text(points, "point")));
  }
  if (kind == InputKind::mesh && !is_upright_by_choice(object) && z < x && z < max_flat_share * y)
    hints.push_back(
        fmt::format("{} lies flat, {}: does its y axis point up? --up y puts it upright",
                    object.file, size_text(box)));
  return hints;
}

}  // namespace lamplock::run
