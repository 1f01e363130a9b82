#include "host/model/read_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/svg_shapes.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

// Nested groups and uses; drawings have a dozen levels.
constexpr int deepest_group = 200;
constexpr double mm_per_px = 25.4 / 96;

/// Inherited properties of an element.
struct Context {
  geometry::Affine map;   ///< to mm
  SvgBox port;            ///< reference of percentages, in the element's units
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

/// The name without the prefix that some programs give all elements of SVG.
std::string_view local_name(const xml_node& node) {
  const std::string_view name = node.name();
  return name.starts_with("svg:") ? name.substr(4) : name;
}

bool is_hidden(const xml_node& node) {
  const auto says = [&](const char* property, std::string_view value) {
    if (node.attribute(property).value() == value) return true;
    std::string style = node.attribute("style").value();
    style.erase(std::remove_if(style.begin(), style.end(), [](char c) { return c == ' '; }),
                style.end());
    return style.find(fmt::format("{}:{}", property, value)) != std::string::npos;
  };
  return says("display", "none") || says("visibility", "hidden") || says("visibility", "collapse");
}

class SvgReader {
 public:
  SvgReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes) {}

  Curves read() {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(
        bytes_.data(), bytes_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
      FilePosition{file_, bytes_, static_cast<std::size_t>(result.offset)}.refuse(
          fmt::format("not valid XML ({})", result.description()), "export the drawing again");
    }
    const xml_node root = document.document_element();
    if (local_name(root) != "svg")
      position_of(root).refuse(fmt::format("the document is '{:.40}', not svg", root.name()),
                               "give an SVG drawing");
    number_ids(root, 0);
    draw_root(root);
    return std::move(curves_).finished(file_);
  }

 private:
  FilePosition position_of(const xml_node& node) const {
    return {file_, bytes_,
            static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0))};
  }

  void number_ids(const xml_node& node, int depth) {
    if (depth > deepest_group)
      position_of(node).refuse(fmt::format("groups are nested deeper than {}", deepest_group),
                               "ungroup some");
    const char* id = node.attribute("id").value();
    if (*id != '\0') by_id_.try_emplace(id, node);
    for (const xml_node& child : node.children()) number_ids(child, depth + 1);
  }

  /// Changes to the units of the node's viewBox, if it has one, fitted into `port`.
  void enter_view(const xml_node& node, const SvgBox& port, Context& context) const {
    context.port = port;
    const char* text = node.attribute("viewBox").value();
    if (*text == '\0') {
      context.map = context.map * geometry::moved(port.x, port.y, 0);
      return;
    }
    const std::vector<double> view = svg_numbers(text, position_of(node));
    if (view.size() != 4 || !(view[2] > 0) || !(view[3] > 0))
      position_of(node).refuse(fmt::format("the viewBox '{:.40}' is not valid", text),
                               "repair the drawing");
    context.port = {view[0], view[1], view[2], view[3]};
    context.map =
        context.map * svg_fit(context.port, port, node.attribute("preserveAspectRatio").value());
  }

  /// Draws the page: its size in px, its lower left corner in the origin, y upwards.
  void draw_root(const xml_node& root) {
    // Without a size the page, the reference of percentages, has the size of the view.
    const std::vector<double> view =
        svg_numbers(root.attribute("viewBox").value(), position_of(root));
    const bool has_view = view.size() == 4;
    const SvgBox whole{0, 0, has_view ? view[2] : 0, has_view ? view[3] : 0};
    const FilePosition place = position_of(root);
    const SvgBox page{0, 0, svg_length_of(root, "width", whole.width, whole.width, place),
                      svg_length_of(root, "height", whole.height, whole.height, place)};
    const bool is_empty = has_view && (page.width == 0 || page.height == 0);
    if (page.width < 0 || page.height < 0 || is_empty)
      place.refuse(fmt::format("the page has the size {} x {}", page.width, page.height),
                   "repair the drawing");
    Context context;
    context.map =
        geometry::moved(0, page.height * mm_per_px, 0) * geometry::scaled(mm_per_px, -mm_per_px, 1);
    enter_view(root, page, context);
    if (is_hidden(root)) return curves_.leave_out("hidden");
    draw_children(root, context);
  }

  void draw_children(const xml_node& node, const Context& context) {
    for (const xml_node& child : node.children()) {
      if (child.type() == pugi::node_element) draw(child, context);
    }
  }

  void draw(const xml_node& node, Context context) {
    const std::string_view name = local_name(node);
    if (draws_nothing(name)) return;
    if (is_hidden(node)) return curves_.leave_out("hidden");
    const FilePosition place = position_of(node);
    curves_.spend(1, place);
    if (++context.depth > deepest_group)
      place.refuse(fmt::format("groups are nested deeper than {}", deepest_group), "ungroup some");
    context.map = context.map * svg_transform(node.attribute("transform").value(), place);
    if (name == "g" || name == "a" || name == "switch") {
      enter_layer(node, context);
      draw_children(node, context);
    } else if (name == "svg") {
      draw_view(node, with_default_size(svg_box_of(node, context.port, place), context.port),
                context);
    } else if (name == "use") {
      draw_use(node, context);
    } else {
      draw_shape(node, name, context);
    }
  }

  static SvgBox with_default_size(SvgBox port, const SvgBox& outer) {
    if (port.width == 0) port.width = outer.width;
    if (port.height == 0) port.height = outer.height;
    return port;
  }

  void draw_view(const xml_node& node, const SvgBox& port, Context context) {
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
    std::string_view target = node.attribute("href").value();
    if (target.empty()) target = node.attribute("xlink:href").value();
    if (!target.starts_with('#')) return curves_.leave_out("use of another file");
    const auto found = by_id_.find(std::string(target.substr(1)));
    if (found == by_id_.end())
      position_of(node).refuse(fmt::format("there is no element '{:.40}'", target.substr(1)),
                               "repair the drawing");
    const xml_node used = found->second;
    if (std::find(open_uses_.begin(), open_uses_.end(), used) != open_uses_.end())
      position_of(node).refuse(fmt::format("'{:.40}' uses itself", target.substr(1)),
                               "repair the drawing");
    const SvgBox at = svg_box_of(node, context.port, position_of(node));
    context.map = context.map * geometry::moved(at.x, at.y, 0);
    open_uses_.push_back(used);
    if (local_name(used) == "symbol" || local_name(used) == "svg") {
      draw_view(used, with_default_size({0, 0, at.width, at.height}, context.port), context);
    } else {
      draw(used, context);
    }
    open_uses_.pop_back();
  }

  void draw_shape(const xml_node& node, std::string_view name, const Context& context) {
    const FilePosition place = position_of(node);
    auto paths = svg_shape(node, name, context.port, place);
    if (!paths) return curves_.leave_out(std::string(name));
    for (Path& path : *paths) curves_.add(std::move(path), context.map, context.layer, place);
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::unordered_map<std::string, xml_node> by_id_;
  std::vector<xml_node> open_uses_;
  CurveCollector curves_;
};

}  // namespace

Curves read_svg(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return SvgReader(path, bytes).read();
}

}  // namespace lamplock::model
