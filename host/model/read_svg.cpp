#include "host/model/read_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/clip.hpp"
#include "host/model/close_path.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/dashes.hpp"
#include "host/model/svg_background.hpp"
#include "host/model/svg_clips.hpp"
#include "host/model/svg_document.hpp"
#include "host/model/svg_elements.hpp"
#include "host/model/svg_paint.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/model/svg_style.hpp"
#include "host/model/svg_text.hpp"
#include "host/model/svg_values.hpp"
#include "host/model/svg_views.hpp"

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

/// The factor of lengths of a map of the plane: the root of that of areas.
double scale_of(const geometry::Affine& map) {
  return std::sqrt(std::abs(map.x.x * map.y.y - map.x.y * map.y.x));
}

geometry::Bounds moved_back(geometry::Bounds box, const SvgBox& by) {
  for (geometry::Point* corner : {&box.low, &box.high}) {
    corner->x -= by.x;
    corner->y -= by.y;
  }
  return box;
}

class SvgReader {
 public:
  SvgReader(const std::filesystem::path& file, std::string bytes, bool keeps_texts)
      : file_(file),
        document_(file, std::move(bytes)),
        clips_(document_),
        keeps_texts_(keeps_texts) {}

  LetteredDrawing read() {
    for (const auto& [name, count] : document_.left_out()) curves_.leave_out(name, count);
    draw_root(document_.root());
    settle_background();
    Curves curves =
        texts_.empty() ? std::move(curves_).finished(file_) : std::move(curves_).collected();
    return {std::move(curves), std::move(texts_)};
  }

 private:
  void leave_out(const std::string& name) {
    if (!measured_) curves_.leave_out(name);
  }

  void enter_view(const xml_node& node, const SvgBox& port, Context& context) const {
    context.map =
        context.map * svg_view_map(node, port, context.units, document_.position_of(node));
  }

  /// Draws the page: its size in px, its lower left corner in the origin, y upwards.
  void draw_root(const xml_node& root) {
    Context context;
    context.units.font_px = svg_font_size(svg_value(root, "font-size"), context.units);
    context.units.root_font_px = context.units.font_px;
    page_ = svg_page(root, context.units, document_.position_of(root));
    context.map = geometry::moved(0, page_.height * mm_per_px, 0) *
                  geometry::scaled(mm_per_px, -mm_per_px, 1);
    if (is_not_rendered(root)) return leave_out("hidden");
    inherit_paint(root, context.units, document_, context.paint);
    context.units.port = page_;  // its transform is that of the page
    context.map = context.map * own_map(root, context);
    if (scale_of(context.map) == 0) return leave_out("hidden");
    enter_view(root, page_, context);
    if (!clip(root, context)) return;
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
      leave_out("hidden");
      return false;
    }
    SvgUnits& units = context.units;
    units.font_px = svg_font_size(svg_value(node, "font-size"), units);
    if (const auto filter = svg_value(node, "filter"); !filter.empty() && filter != "none")
      leave_out("filter");
    context.map = context.map * own_map(node, context);
    inherit_paint(node, units, document_, context.paint);
    if (scale_of(context.map) == 0) {  // flattened to a line by its transform
      leave_out("hidden");
      return false;
    }
    return true;
  }

  /// The transform of an element about its origin, and the single properties of CSS before it.
  geometry::Affine own_map(const xml_node& node, const Context& context) {
    const FilePosition place = document_.position_of(node);
    const geometry::Affine map = svg_own_transform(node, context.units, place);
    if (map == geometry::Affine{}) return map;
    SvgBox reference = context.units.port;
    const std::string_view box_name = svg_value(node, "transform-box");
    if (box_name == "fill-box" || box_name == "stroke-box" || box_name == "content-box") {
      const auto box = box_of(node, context);
      if (!box) leave_out("transform-box");
      if (box)
        reference = {box->low.x, box->low.y, box->high.x - box->low.x, box->high.y - box->low.y};
    } else if (svg_value(node, "transform-origin").empty()) {
      return map;
    }
    const geometry::Point about = svg_transform_origin(node, reference, context.units, place);
    return geometry::moved(about.x, about.y, 0) * map * geometry::moved(-about.x, -about.y, 0);
  }

  /// The box of what an element draws, in its own units; empty without a shape, or with elements
  /// whose shape is not known, such as text.
  std::optional<geometry::Bounds> box_of(const xml_node& node, Context context) {
    context.map = {};
    context.clips = {};
    // Groups in groups would be measured again for each of them.
    const auto known = boxes_.find(node.hash_value());
    if (known != boxes_.end() && known->second.units == context.units) return known->second.box;
    const auto outer = std::exchange(measured_, Measured{});
    draw_content(node, svg_name(node), context);
    const auto measured = std::exchange(measured_, outer);
    std::optional<geometry::Bounds> box;
    if (measured->is_known && !measured->corners.empty()) box = geometry::bounds(measured->corners);
    boxes_[node.hash_value()] = {context.units, box};
    return box;
  }

  void measure(const std::optional<std::vector<Path>>& paths, const Context& context,
               const FilePosition& place) {
    measured_->is_known = measured_->is_known && paths;
    if (!paths || paths->empty()) return;
    Curves curves;
    for (const Path& path : *paths) {
      curves_.spend(path.pieces.size(), place);
      curves.paths.push_back(CurveCollector::placed(path, context.map, place));
    }
    const geometry::Bounds box = bounds(curves);
    measured_->corners.insert(measured_->corners.end(), {box.low, box.high});
  }

  bool clip(const xml_node& node, Context& context) {
    if (measured_) return true;
    SvgClips::Frame frame{context.map, context.units, {}};
    if (clips_.needs_box(node)) frame.box = box_of(node, context);
    if (svg_name(node) == "use") {  // its x and y move what clips it, too
      const SvgBox at = svg_box_of(node, context.units, document_.position_of(node));
      frame.map = frame.map * geometry::moved(at.x, at.y, 0);
      if (frame.box) *frame.box = moved_back(*frame.box, at);
    }
    if (clips_.append(node, frame, context.clips)) return true;
    leave_out("element with a clip path or mask that cannot be applied");
    return false;
  }

  void draw(const xml_node& node, Context context) {
    const std::string_view name = svg_name(node);
    if (svg_draws_nothing(name)) return;
    if (!svg_conditions_hold(node)) return leave_out("hidden");
    if (enter(node, context)) draw_content(node, name, std::move(context));
  }

  /// Draws an element whose properties are applied.
  void draw_content(const xml_node& node, std::string_view name, Context context) {
    const bool is_group =
        name == "g" || name == "a" || name == "switch" || name == "svg" || name == "use";
    if (!is_group) return draw_shape(node, name, context);
    if (!clip(node, context)) return;
    if (name == "use") return draw_use(node, context);
    if (name == "svg") {
      const FilePosition place = document_.position_of(node);
      return draw_view(node, svg_view_port(node, {}, context.units, place), context);
    }
    enter_layer(node, context);
    if (name != "switch") return draw_children(node, context);
    if (const xml_node chosen = svg_chosen_of(node)) draw(chosen, context);
  }

  /// Draws a nested svg or a symbol. What leaves the view is hidden unless the property overflow
  /// shows it.
  void draw_view(const xml_node& node, const SvgBox& port, Context context) {
    const SvgBox& outer = context.units.port;
    const bool has_size = outer.width > 0 && outer.height > 0;
    if (has_size && (port.width == 0 || port.height == 0)) return leave_out("hidden");
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
    if (!used) return leave_out("use of another file");
    if (std::find(open_uses_.begin(), open_uses_.end(), used) != open_uses_.end())
      place.refuse(fmt::format("'{:.40}' uses itself", used.attribute("id").value()),
                   "repair the drawing");
    const SvgBox at = svg_box_of(node, context.units, place);
    context.map = context.map * geometry::moved(at.x, at.y, 0);
    open_uses_.push_back(used);
    if (svg_name(used) == "symbol" && (used.attribute("refX") || used.attribute("refY")))
      leave_out("reference point of a symbol");
    if (svg_name(used) == "symbol" || svg_name(used) == "svg") {
      if (svg_name(used) == "svg" && !svg_conditions_hold(used))
        leave_out("hidden");
      else if (enter(used, context) && clip(used, context))
        draw_view(used, svg_view_port(used, node, context.units, place), context);
    } else {
      draw(used, context);
    }
    open_uses_.pop_back();
  }

  /// The outlines of letters are not known here, so they cannot be clipped.
  void draw_text(const xml_node& node, Context context) {
    if (!clip(node, context)) return;
    if (!context.clips.empty()) return leave_out("text that is clipped");
    const FilePosition place = document_.position_of(node);
    SvgText text = svg_text(node, context.units, context.paint, document_);
    for (const std::string& name : text.left_out) leave_out(name);
    for (TextBlock& run : text.runs) {
      curves_.spend(run.lines.front().size(), place);
      run.frame = context.map * run.frame;
      run.layer = curves_.layer_number(context.layer);
      if (run.is_filled) run.area = ++areas_;
      texts_.push_back(std::move(run));
      has_drawn_ = true;
    }
  }

  void draw_shape(const xml_node& node, std::string_view name, Context context) {
    const FilePosition place = document_.position_of(node);
    const SvgPaint& paint = context.paint;
    auto paths = svg_shape(node, name, context.units, place);
    if (measured_) return measure(paths, context, place);
    if (!paint.is_visible || (paths && !paint.shows_fill() && !paint.shows_stroke()))
      return leave_out("hidden");
    if (!paths && name == "text" && keeps_texts_) return draw_text(node, context);
    if (!paths) return leave_out(std::string(name));
    if (svg_has_markers(node)) leave_out("marker");
    if (!clip(node, context)) return;
    const bool fills = shows_filled_edge(node, paint);
    const bool is_background = may_be_background(paint, *paths, context, place);
    const std::uint32_t area = paint.shows_fill() && !has_dashes(node, paint) ? ++areas_ : 0;
    for (Path& path : dashed(node, std::move(*paths), context, place)) {
      if (fills) close_around_area(path);
      std::vector<Path> parts = clipped(std::move(path), context.clips, clips_.work(), place);
      if (parts.empty()) leave_out("clipped curve");
      for (Path& part : parts) {
        part.colour = paint.colour();
        part.area = area;
        part.fill_rule = paint.fill_rule;
        part.covers = paint.fill_is_white;
        if (is_background)
          background_.emplace(Background{std::move(part), context.layer, place});
        else
          add(std::move(part), context.layer, place);
      }
    }
  }

  /// The paths in mm, or their dashes where has_dashes().
  std::vector<Path> dashed(const xml_node& node, std::vector<Path> paths, const Context& context,
                           const FilePosition& place) {
    const SvgPaint& paint = context.paint;
    if (!has_dashes(node, paint)) {
      for (Path& path : paths) path = CurveCollector::placed(std::move(path), context.map, place);
      return paths;
    }
    // Lengths are measured in mm, which the precision of arc lengths refers to: along the path as
    // the user draws it, or as the page shows it.
    const bool is_on_page = svg_value(node, "vector-effect") == "non-scaling-stroke";
    const double scale = is_on_page ? mm_per_px : scale_of(context.map);
    const geometry::Affine larger =
        is_on_page ? context.map : geometry::scaled(scale, scale, scale);
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
    const geometry::Affine rest =
        is_on_page ? geometry::Affine{}
                   : context.map * geometry::scaled(1 / scale, 1 / scale, 1 / scale);
    std::vector<Path> all;
    for (const Path& path : paths) {
      for (Path& dash : dashes(path, pattern))
        all.push_back(CurveCollector::placed(std::move(dash), rest, place));
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
    Path outline = CurveCollector::placed(paths.front(), context.map, place);
    close_around_area(outline);
    return is_filled_box(outline,
                         {{0, 0, 0}, {page_.width * mm_per_px, page_.height * mm_per_px, 0}});
  }

  /// The background is a curve only if it is the whole drawing.
  void settle_background() {
    if (!background_) return;
    if (has_drawn_) return leave_out("background of the page");
    curves_.add(std::move(background_->path), {}, background_->layer, background_->place);
  }

  void add(Path path, const std::string& layer, const FilePosition& place) {
    has_drawn_ = true;
    curves_.add(std::move(path), {}, layer, place);
  }

  struct Measured {
    bool is_known = true;
    std::vector<geometry::Point> corners{};
  };
  struct Boxed {
    SvgUnits units{};
    std::optional<geometry::Bounds> box{};
  };
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
  std::uint32_t areas_ = 0;  ///< count of filled areas
  bool keeps_texts_;
  std::vector<TextBlock> texts_;
  std::optional<Measured> measured_;  ///< while an element is measured: nothing is drawn
  std::unordered_map<std::size_t, Boxed> boxes_;  ///< by the hash of the node
  CurveCollector curves_;
};

}  // namespace

Curves read_svg(const std::filesystem::path& path) {
  return SvgReader(path, read_file(path), false).read().curves;
}

LetteredDrawing read_svg_with_texts(const std::filesystem::path& path) {
  return SvgReader(path, read_file(path), true).read();
}

}  // namespace lamplock::model
