#include "host/model/read_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/clip.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/dashes.hpp"
#include "host/model/svg_background.hpp"
#include "host/model/svg_clips.hpp"
#include "host/model/svg_document.hpp"
#include "host/model/svg_paint.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/model/svg_style.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

constexpr double mm_per_px = 25.4 / 96;

/// What an element inherits.
struct Context {
  geometry::Affine map;  ///< to mm
  SvgUnits units{};
  SvgPaint paint{};
  ClipRegions clips{};
  std::string layer{};    ///< name, empty outside of layers
  bool is_named = false;  ///< the layer has a name by Inkscape
  int depth = 0;
};

/// Elements that draw nothing by themselves.
bool draws_nothing(std::string_view name) {
  constexpr std::array<std::string_view, 15> names{
      "defs",           "metadata", "title",    "desc",   "style",
      "script",         "symbol",   "clipPath", "mask",   "linearGradient",
      "radialGradient", "pattern",  "marker",   "filter", "view"};
  return std::find(names.begin(), names.end(), name) != names.end() ||
         name.find(':') != std::string_view::npos;  // of editors
}

/// The factor of lengths of a map of the plane: the root of that of areas.
double scale_of(const geometry::Affine& map) {
  return std::sqrt(std::abs(map.x.x * map.y.y - map.x.y * map.y.x));
}

/// The first element of a `switch` whose conditions hold: no extension is known, and the language
/// is English.
xml_node chosen_of(const xml_node& node) {
  for (const xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    const bool extends = *child.attribute("requiredExtensions").value() != 0;
    const std::string_view languages = child.attribute("systemLanguage").value();
    const bool fits = !child.attribute("systemLanguage") || languages.starts_with("en") ||
                      languages.find(",en") != std::string_view::npos ||
                      languages.find(" en") != std::string_view::npos;
    if (!extends && fits) return child;
  }
  return {};
}

bool has_markers(const xml_node& node) {
  for (const char* name : {"marker-start", "marker-mid", "marker-end"}) {
    const std::string_view value = svg_value(node, name);
    if (!value.empty() && value != "none") return true;
  }
  return false;
}

class SvgReader {
 public:
  SvgReader(const std::filesystem::path& file, std::string bytes)
      : file_(file), document_(file, std::move(bytes)), clips_(document_) {}

  Curves read() {
    if (document_.unread_rules() > 0)
      curves_.leave_out("rule of a style sheet", document_.unread_rules());
    draw_root(document_.root());
    settle_background();
    return std::move(curves_).finished(file_);
  }

 private:
  /// Changes to the units of the node's viewBox, if it has one, fitted into `port`.
  void enter_view(const xml_node& node, const SvgBox& port, Context& context) const {
    const FilePosition place = document_.position_of(node);
    context.units.port = port;
    const char* text = node.attribute("viewBox").value();
    if (*text == '\0') {
      context.map = context.map * geometry::moved(port.x, port.y, 0);
      return;
    }
    const std::vector<double> view = svg_numbers(text, place);
    if (view.size() != 4 || !(view[2] > 0) || !(view[3] > 0))
      place.refuse(fmt::format("the viewBox '{:.40}' is not valid", text), "repair the drawing");
    context.units.port = {view[0], view[1], view[2], view[3]};
    context.map = context.map *
                  svg_fit(context.units.port, port, node.attribute("preserveAspectRatio").value());
  }

  /// The page in px. Without a size the page, the reference of percentages, has that of the view.
  SvgBox page_of(const xml_node& root, SvgUnits& units) const {
    const FilePosition place = document_.position_of(root);
    const std::vector<double> view = svg_numbers(root.attribute("viewBox").value(), place);
    const bool has_view = view.size() == 4;
    const SvgBox whole{0, 0, has_view ? view[2] : 0, has_view ? view[3] : 0};
    units.port = whole;
    units.page_width_px = whole.width;
    units.page_height_px = whole.height;
    const SvgBox page{0, 0, svg_length_of(root, "width", whole.width, whole.width, units, place),
                      svg_length_of(root, "height", whole.height, whole.height, units, place)};
    const bool is_empty = has_view && (page.width == 0 || page.height == 0);
    if (page.width < 0 || page.height < 0 || is_empty)
      place.refuse(fmt::format("the page has the size {} x {}", page.width, page.height),
                   "repair the drawing");
    units.page_width_px = page.width;
    units.page_height_px = page.height;
    return page;
  }

  /// Draws the page: its size in px, its lower left corner in the origin, y upwards.
  void draw_root(const xml_node& root) {
    Context context;
    context.units.font_px = svg_font_size(svg_value(root, "font-size"), context.units);
    context.units.root_font_px = context.units.font_px;
    page_ = page_of(root, context.units);
    context.map = geometry::moved(0, page_.height * mm_per_px, 0) *
                  geometry::scaled(mm_per_px, -mm_per_px, 1);
    if (is_not_rendered(root)) return curves_.leave_out("hidden");
    inherit_paint(root, context.units, document_, context.paint);
    enter_view(root, page_, context);
    if (!clips_.append(root, {context.map, context.units, {}}, context.clips))
      return curves_.leave_out("element with a clip path or mask that cannot be applied");
    draw_children(root, context);
  }

  void draw_children(const xml_node& node, const Context& context) {
    for (const xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) draw(child, context);
    }
  }

  /// Applies the properties of an element. False if nothing of it is drawn.
  bool enter(const xml_node& node, Context& context) {
    const FilePosition place = document_.position_of(node);
    curves_.spend(1, place);
    if (++context.depth > max_svg_depth)
      place.refuse(fmt::format("groups are nested deeper than {}", max_svg_depth), "ungroup some");
    if (is_not_rendered(node)) {
      curves_.leave_out("hidden");
      return false;
    }
    SvgUnits& units = context.units;
    units.font_px = svg_font_size(svg_value(node, "font-size"), units);
    context.map = context.map * own_map(node, units, place);
    inherit_paint(node, units, document_, context.paint);
    if (scale_of(context.map) == 0) {  // flattened to a line by its transform
      curves_.leave_out("hidden");
      return false;
    }
    return true;
  }

  /// The transform of an element about its origin, and the single properties of CSS before it.
  static geometry::Affine own_map(const xml_node& node, const SvgUnits& units,
                                  const FilePosition& place) {
    geometry::Affine map;
    for (const char* name : {"translate", "rotate", "scale"}) {
      const std::string_view value = svg_value(node, name);
      if (value.empty() || value == "none") continue;
      map = map * svg_transform(fmt::format("{}({})", name, value), units, place);
    }
    map = map * svg_transform(svg_value(node, "transform"), units, place);
    const std::string origin(svg_value(node, "transform-origin"));
    if (origin.empty() || map == geometry::Affine{}) return map;
    const std::size_t blank = origin.find(' ');
    const auto part = [&](std::string_view text, double whole) {
      if (text == "left" || text == "top") return 0.0;
      if (text == "center" || text.empty()) return whole / 2;
      if (text == "right" || text == "bottom") return whole;
      return svg_length(text, whole, units, place);
    };
    const std::string y =
        blank == std::string::npos ? "" : origin.substr(origin.find_first_not_of(' ', blank));
    const SvgBox& port = units.port;
    const double about_x = port.x + part(origin.substr(0, blank), port.width);
    const double about_y = port.y + part(y.substr(0, y.find(' ')), port.height);
    return geometry::moved(about_x, about_y, 0) * map * geometry::moved(-about_x, -about_y, 0);
  }

  bool clip(const xml_node& node, const std::optional<geometry::Bounds>& box, Context& context) {
    if (clips_.append(node, {context.map, context.units, box}, context.clips)) return true;
    curves_.leave_out("element with a clip path or mask that cannot be applied");
    return false;
  }

  void draw(const xml_node& node, Context context) {
    const std::string_view name = svg_name(node);
    if (draws_nothing(name) || !enter(node, context)) return;
    const bool is_group =
        name == "g" || name == "a" || name == "switch" || name == "svg" || name == "use";
    if (!is_group) return draw_shape(node, name, context);
    if (!clip(node, {}, context)) return;
    if (name == "use") return draw_use(node, context);
    if (name == "svg") {
      const SvgBox box = svg_box_of(node, context.units, document_.position_of(node));
      return draw_view(node, node, box, context);
    }
    enter_layer(node, context);
    if (name != "switch") return draw_children(node, context);
    if (const xml_node chosen = chosen_of(node)) draw(chosen, context);
  }

  /// Draws a nested svg or a symbol; `sized` has the attributes of its size, which is 100 % by
  /// default. What leaves the view is hidden unless the property overflow shows it.
  void draw_view(const xml_node& node, const xml_node& sized, SvgBox port, Context context) {
    const SvgBox& outer = context.units.port;
    const auto size = [&](const char* name, double given, double whole) {
      const std::string_view text = svg_value(sized, name);
      return text.empty() || text == "auto" ? whole : given;
    };
    port.width = size("width", port.width, outer.width);
    port.height = size("height", port.height, outer.height);
    const bool has_size = outer.width > 0 && outer.height > 0;
    if (has_size && (port.width == 0 || port.height == 0)) return curves_.leave_out("hidden");
    const std::string_view overflow = svg_value(node, "overflow");
    if (has_size && overflow != "visible" && overflow != "auto")
      clips_.append(port, context.map, document_.position_of(node), context.clips);
    enter_view(node, port, context);
    draw_children(node, context);
  }

  static void enter_layer(const xml_node& node, Context& context) {
    const char* label = node.attribute("inkscape:label").value();
    const char* id = node.attribute("id").value();
    if (std::string_view(node.attribute("inkscape:groupmode").value()) == "layer") {
      context.layer = *label != '\0' ? label : id;
      context.is_named = true;
    } else if (!context.is_named && context.layer.empty()) {
      context.layer = id;
    }
  }

  void draw_use(const xml_node& node, Context context) {
    const FilePosition place = document_.position_of(node);
    const xml_node used = document_.used_by(node);
    if (!used) return curves_.leave_out("use of another file");
    if (std::find(open_uses_.begin(), open_uses_.end(), used) != open_uses_.end())
      place.refuse(fmt::format("'{:.40}' uses itself", used.attribute("id").value()),
                   "repair the drawing");
    const SvgBox at = svg_box_of(node, context.units, place);
    context.map = context.map * geometry::moved(at.x, at.y, 0);
    open_uses_.push_back(used);
    if (svg_name(used) == "symbol" || svg_name(used) == "svg") {
      if (enter(used, context) && clip(used, {}, context)) {
        const bool has_size = node.attribute("width") || node.attribute("height");
        SvgBox port = svg_box_of(used, context.units, place);
        if (has_size) port = {port.x, port.y, at.width, at.height};
        draw_view(used, has_size ? node : used, port, context);
      }
    } else {
      draw(used, context);
    }
    open_uses_.pop_back();
  }

  void draw_shape(const xml_node& node, std::string_view name, Context context) {
    const FilePosition place = document_.position_of(node);
    const SvgPaint& paint = context.paint;
    auto paths = svg_shape(node, name, context.units, place);
    if (!paint.is_visible || (paths && !paint.shows_fill() && !paint.shows_stroke()))
      return curves_.leave_out("hidden");
    if (!paths) return curves_.leave_out(std::string(name));
    if (has_markers(node)) curves_.leave_out("marker");
    std::optional<geometry::Bounds> box;
    if (*node.attribute("clip-path").value() != 0 || *node.attribute("mask").value() != 0)
      box = box_of(*paths, place);
    if (!clip(node, box, context)) return;
    const bool is_background = may_be_background(paint, *paths, context, place);
    for (Path& path : dashed(node, std::move(*paths), context, place)) {
      path = CurveCollector::placed(std::move(path), context.map, place);
      std::vector<Path> parts = clipped(std::move(path), context.clips, clips_.work(), place);
      if (parts.empty()) curves_.leave_out("clipped curve");
      for (Path& part : parts) {
        if (is_background)
          background_.emplace(Background{std::move(part), context.layer, place});
        else
          add(std::move(part), context.layer, place);
      }
    }
  }

  static geometry::Bounds box_of(const std::vector<Path>& paths, const FilePosition& place) {
    Curves curves;
    for (const Path& path : paths) curves.paths.push_back(CurveCollector::placed(path, {}, place));
    return bounds(curves);
  }

  /// The dashes of the paths where the stroke has some; the edge of a fill in another colour than
  /// the page's is whole.
  std::vector<Path> dashed(const xml_node& node, std::vector<Path> paths, const Context& context,
                           const FilePosition& place) {
    const SvgPaint& paint = context.paint;
    const bool shows_edge = paint.shows_fill() && !paint.fill_is_default && !paint.fill_is_white &&
                            svg_name(node) != "line";
    if (paint.dashes.empty() || !paint.shows_stroke() || shows_edge) return paths;
    // Lengths are measured in mm, which the precision of arc lengths refers to.
    const double scale = scale_of(context.map);
    const geometry::Affine larger = geometry::scaled(scale, scale, scale);
    std::vector<double> lengths;
    for (Path& path : paths) {
      path = CurveCollector::placed(std::move(path), larger, place);
      lengths.push_back(ArcLength(path).total());
    }
    const double total = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    const auto stated = find_svg_length(svg_value(node, "pathLength"), 0, {});
    const double factor = stated && *stated > 0 ? total / *stated : scale;
    DashPattern pattern{paint.dashes, paint.dash_offset * factor, paint.has_long_ends};
    for (double& length : pattern.lengths) length *= factor;
    double count = 0;
    for (const double length : lengths) count += dash_count(pattern, length);
    if (!(count <= static_cast<double>(max_pieces)))
      place.refuse(fmt::format("the curve has more than {} dashes", max_pieces),
                   "use longer dashes");
    curves_.spend(static_cast<std::size_t>(count), place);
    const geometry::Affine smaller = geometry::scaled(1 / scale, 1 / scale, 1 / scale);
    std::vector<Path> all;
    for (const Path& path : paths) {
      for (Path& dash : dashes(path, pattern))
        all.push_back(CurveCollector::placed(std::move(dash), smaller, place));
    }
    return all;
  }

  /// A coloured rectangle without a stroke under everything else, as large as the page: its edge is
  /// that of the page.
  bool may_be_background(const SvgPaint& paint, const std::vector<Path>& paths,
                         const Context& context, const FilePosition& place) const {
    if (has_drawn_ || background_ || paint.shows_stroke() || paint.fill_is_default ||
        paths.size() != 1 || page_.width == 0 || page_.height == 0)
      return false;
    const Path outline = CurveCollector::placed(paths.front(), context.map, place);
    return is_filled_box(outline,
                         {{0, 0, 0}, {page_.width * mm_per_px, page_.height * mm_per_px, 0}});
  }

  /// The background is a curve only if it is the whole drawing.
  void settle_background() {
    if (!background_) return;
    if (has_drawn_) return curves_.leave_out("background of the page");
    curves_.add(std::move(background_->path), {}, background_->layer, background_->place);
  }

  void add(Path path, const std::string& layer, const FilePosition& place) {
    has_drawn_ = true;
    curves_.add(std::move(path), {}, layer, place);
  }

  struct Background {
    Path path;
    std::string layer;
    FilePosition place;
  };

  const std::filesystem::path& file_;
  SvgDocument document_;
  SvgClips clips_;
  SvgBox page_;
  std::vector<xml_node> open_uses_;
  std::optional<Background> background_;
  bool has_drawn_ = false;
  CurveCollector curves_;
};

}  // namespace

Curves read_svg(const std::filesystem::path& path) {
  return SvgReader(path, read_file(path)).read();
}

}  // namespace lamplock::model
