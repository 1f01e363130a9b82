#include "host/model/input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/foreign_formats.hpp"
#include "host/model/ply.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/model/read_dxf.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/read_points.hpp"
#include "host/model/read_svg.hpp"
#include "host/shell_text.hpp"
#include "host/similar_files.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

template <auto read>
Input read_as(const path& file) {
  return read(file);
}

Input read_mesh_or_points(const path& file) {
  const std::string bytes = read_file(file);
  if (read_ply_header(file, bytes).has_surface()) return decode_mesh(file, bytes);
  return decode_point_list(file, bytes);
}

Input read_curves_or_points(const path& file) {
  Curves drawing = read_dxf(file);
  if (drawing.paths.empty()) return points_of_drawing(file, std::move(drawing));
  return drawing;
}

struct Format {
  std::string_view extension;
  InputKind kind;
  Input (*read)(const path&);
};

/// An extension whose files are of one of two kinds has two rows with the same reader.
constexpr Format formats[] = {
    {".stl", InputKind::mesh, read_as<read_mesh>},
    {".obj", InputKind::mesh, read_as<read_mesh>},
    {".ply", InputKind::mesh, read_mesh_or_points},
    {".3mf", InputKind::mesh, read_as<read_mesh>},
    {".glb", InputKind::mesh, read_as<read_mesh>},
    {".dxf", InputKind::curves, read_curves_or_points},
    {".svg", InputKind::curves, read_as<read_svg>},
    {".svgz", InputKind::curves, read_as<read_svg>},
    {".png", InputKind::bitmap, read_as<read_bitmap>},
    {".bmp", InputKind::bitmap, read_as<read_bitmap>},
    {".jpg", InputKind::bitmap, read_as<read_bitmap>},
    {".jpeg", InputKind::bitmap, read_as<read_bitmap>},
    {".xyz", InputKind::points, read_as<read_point_list>},
    {".txt", InputKind::points, read_as<read_point_list>},
    {".csv", InputKind::points, read_as<read_point_list>},
    {".asc", InputKind::points, read_as<read_point_list>},
    {".cad", InputKind::points, read_as<read_point_list>},
    {".ply", InputKind::points, read_mesh_or_points},
    {".dxf", InputKind::points, read_curves_or_points},
};

/// Pictures of other formats: the reader refuses them with a hint, unless their extension is wrong.
constexpr Format foreign_picture{"", InputKind::bitmap, read_as<read_bitmap>};

/// The example model is the one that guides and examples name: it is written by a command.
std::string missing_model_remedy(const path& file) {
  std::string remedy = missing_path_remedy(file);
  if (remedy.ends_with('?') || lower_extension(file) != ".stl") return remedy;
  return fmt::format("{}; {} writes the example model", remedy,
                     shell_text({"lamplock", "example", file.string()}));
}

/// "give a mesh (stl, obj, ...), a drawing (...), ..."; of one kind: "give a drawing (...)".
std::string other_file_remedy(std::optional<InputKind> wanted) {
  constexpr std::pair<InputKind, const char*> kinds[] = {{InputKind::mesh, "a mesh"},
                                                         {InputKind::curves, "a drawing"},
                                                         {InputKind::bitmap, "a picture"},
                                                         {InputKind::points, "points"}};
  std::vector<std::string> texts;
  for (const auto& [kind, name] : kinds)
    if (!wanted || kind == *wanted) texts.push_back(fmt::format("{} ({})", name, extensions(kind)));
  const std::string last = texts.back();
  texts.pop_back();
  return texts.empty() ? "give " + last
                       : fmt::format("give {} or {}", fmt::join(texts, ", "), last);
}

/// The first row of the extension of a file that exists. `wanted`: the only kind that the remedies
/// name.
const Format& format_of(const path& file, std::optional<InputKind> wanted = std::nullopt) {
  std::error_code failure;
  if (!std::filesystem::exists(file, failure))
    refuse(file, "no such file", missing_model_remedy(file));
  const std::string extension = lower_extension(file);
  if (is_foreign_picture(extension)) return foreign_picture;
  if (const ForeignFormat* const other = find_foreign_format(extension))
    refuse(file, fmt::format("it is {}, which is not read", other->what),
           other->is_model && wanted == InputKind::curves ? other_file_remedy(wanted)
                                                          : std::string(other->remedy));
  const auto* const found = std::ranges::find(formats, extension, &Format::extension);
  if (found == std::end(formats))
    refuse(file, fmt::format("unknown kind of file '{}'", extension), other_file_remedy(wanted));
  return *found;
}

}  // namespace

Input read_input(const path& file) { return format_of(file).read(file); }

bool may_hold_only(const path& file, InputKind kind) {
  (void)format_of(file, kind);
  return may_hold(file, kind);
}

bool may_hold(const path& file, InputKind kind) {
  const std::string_view extension = format_of(file).extension;
  return std::ranges::any_of(
      formats, [&](const Format& row) { return row.extension == extension && row.kind == kind; });
}

std::optional<InputKind> kind_of(const path& file) {
  const auto* const found = std::ranges::find(formats, lower_extension(file), &Format::extension);
  if (found == std::end(formats)) return std::nullopt;
  return found->kind;
}

std::string extensions(InputKind kind) {
  std::string names;
  for (const Format& row : formats) {
    if (row.kind != kind) continue;
    if (!names.empty()) names += ", ";
    names += row.extension.substr(1);
  }
  return names;
}

}  // namespace lamplock::model
