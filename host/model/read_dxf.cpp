#include "host/model/read_dxf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "host/file.hpp"
#include "host/letter_case.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/dxf_binary.hpp"
#include "host/model/dxf_entities.hpp"
#include "host/model/dxf_groups.hpp"
#include "host/model/dxf_hatch.hpp"
#include "host/model/dxf_text.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

// Nested blocks; drawings have a handful of levels.
constexpr std::size_t deepest_block = 64;

// Colour numbers that refer to what an entity belongs to (DXF Reference, group 62).
constexpr int by_block = 0, by_layer = 256;

/// The colour of an entity as the file has it.
struct DxfColour {
  int number = by_layer;
  Colour rgb = no_colour;  ///< group 420, before the number
};

/// A drawn item, with its place for errors.
struct Item {
  std::variant<std::vector<Path>, Point, DxfInsert, std::vector<DxfBoundary>, TextBlock> what;
  std::string layer;
  FilePosition place;
  DxfColour colour{};
};

struct Block {
  Point base;
  bool is_of_another_file = false;
  std::vector<Item> items;
  std::map<std::string, std::string> layers_of_handles;  ///< of the items
  std::map<std::string, std::size_t> left_out;
};

/// Names of layers and blocks do not distinguish cases.
std::string key(std::string_view name) { return in_lower_case(name); }

/// mm in a unit of $INSUNITS by its number (DXF Reference, HEADER section); 0 for units that no
/// drawing of a workpiece has, such as light years.
double mm_in_unit(int unit) {
  constexpr double inch = 25.4, survey_foot = 1'200'000.0 / 3937;
  constexpr std::array<double, 25> mm{1,
                                      inch,
                                      12 * inch,
                                      63'360 * inch,
                                      1,
                                      10,
                                      1000,
                                      1e6,
                                      inch * 1e-6,
                                      inch * 1e-3,
                                      36 * inch,
                                      1e-7,
                                      1e-6,
                                      1e-3,
                                      100,
                                      1e4,
                                      1e5,
                                      0,
                                      0,
                                      0,
                                      0,
                                      survey_foot,
                                      survey_foot / 12,
                                      survey_foot * 3,
                                      survey_foot * 5280};
  return unit >= 0 && unit < static_cast<int>(mm.size()) ? mm[static_cast<std::size_t>(unit)] : 0;
}

class DxfReader {
 public:
  DxfReader(const std::filesystem::path& file, std::string_view bytes, bool was_binary,
            bool keeps_texts)
      : file_(file), dxf_(file, bytes, was_binary), keeps_texts_(keeps_texts) {}

  LetteredDrawing read() {
    while (true) {
      dxf_.next_entity(entity_);
      if (entity_.kind == "EOF") return finished();
      if (entity_.kind != "SECTION" || entity_.groups.empty()) {
        dxf_.position_of(entity_.kind)
            .refuse(fmt::format("'{:.20}' outside of a section", entity_.kind),
                    "export the drawing again");
      }
      const std::string_view name = entity_.groups.front().value;
      if (name == "HEADER") read_header();
      if (name == "TABLES") {
        while (next_in_section()) read_table_entry();
      } else if (name == "BLOCKS") {
        while (next_in_section()) read_block();
      } else if (name == "ENTITIES") {
        read_entities();
      } else {
        while (next_in_section()) continue;
      }
    }
  }

 private:
  /// What items of a block inherit from where it is inserted.
  struct Inherited {
    std::string layer;
    Colour colour = no_colour;
  };

  LetteredDrawing finished() {
    if (!has_unit_) {
      curves_.warn_of_unit(fmt::format(
          "the drawing names no unit ($INSUNITS){}: its numbers are taken as mm",
          is_imperial_ ? ", though it was drawn in inches and feet ($MEASUREMENT)" : ""));
    }
    Curves curves =
        texts_.empty() ? std::move(curves_).finished(file_) : std::move(curves_).collected();
    return {std::move(curves), std::move(texts_), hatches_, std::move(unknown_unit_)};
  }

  /// The next entity, false at the end of the section.
  bool next_in_section() {
    dxf_.next_entity(entity_);
    if (entity_.kind == "EOF") {
      dxf_.position_of(entity_.kind)
          .refuse("the drawing is cut off: a section has no end", "export the drawing again");
    }
    return entity_.kind != "ENDSEC";
  }

  /// Variables follow each other: name (9), then values.
  void read_header() {
    std::string_view variable;
    for (const DxfGroup& group : entity_.groups) {
      if (group.code == 9) variable = group.value;
      if (group.code != 70) continue;
      if (variable == "$MEASUREMENT") is_imperial_ = dxf_.integer(group) == 0;
      if (variable != "$INSUNITS") continue;
      double mm = mm_in_unit(dxf_.integer(group));
      const bool is_unknown = mm == 0;
      if (is_unknown && keeps_texts_) {
        unknown_unit_ = group.value;
        mm = 1;
      } else if (is_unknown) {
        dxf_.position_of(group.value)
            .refuse(fmt::format("$INSUNITS is {:.20}, not a usable unit of length", group.value),
                    "set the drawing's unit to mm");
      }
      unit_ = geometry::scaled(mm, mm, mm);
      curves_.set_unit(mm);
      has_unit_ = !is_unknown && dxf_.integer(group) != 0;
    }
  }

  void read_table_entry() {
    constexpr int frozen = 1, is_plotted = 290;
    if (entity_.kind != "LAYER") return;
    const std::string name = key(dxf_.text(entity_, 2));
    if ((dxf_.integer(entity_, 70) & frozen) != 0) frozen_layers_.insert(name);
    // A layer that is off has a negative colour.
    if (dxf_.integer(entity_, 62) < 0) off_layers_.insert(name);
    DxfColour colour = colour_of(0);
    colour.number = std::abs(std::max(colour.number, -by_layer));
    layer_colours_[name] =
        colour.rgb != no_colour ? colour.rgb : colour_of_aci(colour.number).value_or(no_colour);
    if (dxf_.integer(entity_, is_plotted, 1) == 0) not_plotted_layers_.insert(name);
  }

  /// The colour of entity_; `otherwise` is the number of one without.
  DxfColour colour_of(int otherwise) const {
    constexpr int number = 62, true_colour = 420, all_parts = 0xffffff;
    const int rgb = dxf_.integer(entity_, true_colour, -1);
    return {dxf_.integer(entity_, number, otherwise),
            rgb < 0 ? no_colour : static_cast<Colour>(rgb & all_parts)};
  }

  Colour shown(const DxfColour& colour, const std::string& layer, Colour of_block) const {
    if (colour.rgb != no_colour) return colour.rgb;
    if (colour.number == by_block) return of_block;
    if (colour.number != by_layer) return colour_of_aci(colour.number).value_or(no_colour);
    const auto found = layer_colours_.find(key(layer));
    return found == layer_colours_.end() ? no_colour : found->second;
  }

  void read_block() {
    if (entity_.kind != "BLOCK") return;
    Block block;
    constexpr int of_another_file = 4;
    block.base = dxf_.point(entity_, 10);
    block.is_of_another_file = (dxf_.integer(entity_, 70) & of_another_file) != 0;
    const std::string name = key(dxf_.text(entity_, 2));
    while (next_in_section() && entity_.kind != "ENDBLK") read_item(block);
    blocks_.insert_or_assign(name, std::move(block));
  }

  void read_entities() {
    Block all;
    while (next_in_section()) read_item(all);
    draw(all, unit_, {"0", no_colour});
  }

  /// Appends entity_, with the entities that belong to it.
  void read_item(Block& block) {
    constexpr int on_paper = 67, is_invisible = 60;
    Item item{{},
              std::string(dxf_.text(entity_, 8, "0")),
              dxf_.position_of(entity_.kind),
              colour_of(by_layer)};
    const std::string kind(entity_.kind);
    const bool paper = dxf_.integer(entity_, on_paper) == 1;
    const bool invisible = dxf_.integer(entity_, is_invisible) == 1;
    const std::string handle(dxf_.text(entity_, 5));
    if (kind == "SEQEND") return;
    if (!read_shape(item)) {
      ++block.left_out[kind == "SPLINE" ? "SPLINE without poles" : kind];
    } else if (paper || invisible) {
      ++block.left_out[paper ? "paper space" : "hidden"];
    } else {
      if (!handle.empty()) block.layers_of_handles.insert_or_assign(handle, item.layer);
      block.items.push_back(std::move(item));
    }
  }

  bool read_shape(Item& item) {
    if (entity_.kind == "POLYLINE") return read_polyline(item);
    if (entity_.kind == "POINT") {
      item.what = dxf_.point(entity_, 10);
    } else if (entity_.kind == "INSERT") {
      item.what = dxf_insert(dxf_, entity_);
    } else if (entity_.kind == "3DFACE") {
      item.what = dxf_face(dxf_, entity_);
    } else if (entity_.kind == "HATCH") {
      item.what = dxf_hatch(dxf_, entity_);
    } else if (auto text = keeps_texts_ ? dxf_text(dxf_, entity_) : std::nullopt) {
      item.what = std::move(*text);
    } else if (auto path = dxf_path(dxf_, entity_)) {
      item.what = std::vector<Path>{std::move(*path)};
    } else {
      return false;
    }
    return true;
  }

  bool read_polyline(Item& item) {
    std::vector<DxfEntity> vertices;
    while (dxf_.peek().value == "VERTEX") dxf_.next_entity(vertices.emplace_back());
    if (is_dxf_surface(dxf_, entity_)) return false;
    item.what = std::vector<Path>{dxf_polyline(dxf_, entity_, vertices)};
    return true;
  }

  /// Items on layer 0 of a block get the layer of the block. A layer that is off or not plotted
  /// hides its own items, a frozen one also what is in the blocks inserted on it.
  void draw(const Block& block, const geometry::Affine& map, const Inherited& of_block) {
    for (const auto& [name, count] : block.left_out) curves_.leave_out(name, count);
    for (const Item& item : block.items) {
      const std::string& layer = item.layer == "0" ? of_block.layer : item.layer;
      const Inherited own{layer, shown(item.colour, layer, of_block.colour)};
      const auto* insert = std::get_if<DxfInsert>(&item.what);
      if (insert == nullptr ? is_hidden(layer) : frozen_layers_.contains(key(layer))) {
        curves_.spend(1, item.place);
        leave_out_hidden(layer);
      } else if (insert != nullptr) {
        draw_copies(*insert, map, own, item.place);
      } else {
        draw_item(item, block, map, own, of_block.layer);
      }
    }
  }

  bool is_hidden(const std::string& layer) const {
    return is_switched_off(layer) || not_plotted_layers_.contains(key(layer));
  }
  bool is_switched_off(const std::string& layer) const {
    return frozen_layers_.contains(key(layer)) || off_layers_.contains(key(layer));
  }

  /// A layer that is not plotted looks like any other on the screen: its name is in the notice.
  void leave_out_hidden(const std::string& layer) {
    constexpr std::size_t max_names = 8;
    if (is_switched_off(layer)) return curves_.leave_out("hidden");
    if (named_layers_.size() < max_names) named_layers_.insert(key(layer));
    const bool is_named = named_layers_.contains(key(layer));
    curves_.leave_out(is_named ? fmt::format("on layer '{:.40}', which is not plotted", layer)
                               : "on other layers that are not plotted");
  }

  void draw_item(const Item& item, const Block& block, const geometry::Affine& map,
                 const Inherited& own, const std::string& layer_of_block) {
    if (const auto* point = std::get_if<Point>(&item.what)) {
      curves_.add(*point, map, item.place);
    } else if (const auto* text = std::get_if<TextBlock>(&item.what)) {
      add(*text, map, own, item.place);
    } else if (const auto* paths = std::get_if<std::vector<Path>>(&item.what)) {
      if (paths->empty()) curves_.leave_out("3DFACE without visible edges");
      for (const Path& path : *paths) add(path, map, own, item.place);
    } else {
      const auto is_drawn = [&](const std::string& handle) {
        const auto found = block.layers_of_handles.find(handle);
        return found != block.layers_of_handles.end() &&
               !is_hidden(found->second == "0" ? layer_of_block : found->second);
      };
      draw_hatch(std::get<std::vector<DxfBoundary>>(item.what), is_drawn, map, own, item.place);
    }
  }

  void add(Path path, const geometry::Affine& map, const Inherited& own,
           const FilePosition& place) {
    path.colour = own.colour;
    curves_.add(std::move(path), map, own.layer, place);
  }

  void add(TextBlock text, const geometry::Affine& map, const Inherited& own,
           const FilePosition& place) {
    curves_.spend(text.lines.size(), place);
    text.frame = map * text.frame;
    text.layer = curves_.layer_number(own.layer);
    text.colour = own.colour;
    texts_.push_back(std::move(text));
  }

  /// A boundary whose source objects are drawn themselves is drawn already.
  template <class IsDrawn>
  void draw_hatch(const std::vector<DxfBoundary>& boundaries, const IsDrawn& is_drawn,
                  const geometry::Affine& map, const Inherited& own, const FilePosition& place) {
    if (boundaries.empty()) {
      curves_.spend(1, place);
      curves_.leave_out("HATCH");
    }
    bool is_outlined = false;
    for (const DxfBoundary& boundary : boundaries) {
      curves_.spend(1, place);
      if (!boundary.sources.empty() &&
          std::all_of(boundary.sources.begin(), boundary.sources.end(), is_drawn))
        continue;
      for (const Path& path : boundary.paths) add(path, map, own, place);
      is_outlined = true;
    }
    if (is_outlined) ++hatches_;
  }

  void draw_copies(const DxfInsert& insert, const geometry::Affine& map, const Inherited& own,
                   const FilePosition& place) {
    const auto found = blocks_.find(key(insert.block));
    if (found == blocks_.end())
      place.refuse(fmt::format("there is no block '{:.40}'", insert.block), "repair the drawing");
    const Block& block = found->second;
    if (block.is_of_another_file) {
      curves_.spend(1, place);
      return curves_.leave_out("INSERT of another file");
    }
    if (std::find(open_blocks_.begin(), open_blocks_.end(), &block) != open_blocks_.end())
      place.refuse(fmt::format("the block '{:.40}' contains itself", insert.block),
                   "repair the drawing");
    if (open_blocks_.size() == deepest_block)
      place.refuse(fmt::format("blocks are nested deeper than {}", deepest_block),
                   "explode some blocks");
    open_blocks_.push_back(&block);
    const geometry::Affine from_base =
        insert.scale * geometry::moved(-block.base.x, -block.base.y, -block.base.z);
    for (int row = 0; row < insert.rows; ++row) {
      for (int column = 0; column < insert.columns; ++column) {
        curves_.spend(1 + block.left_out.size(), place);
        const geometry::Affine cell = geometry::moved(column * insert.column, row * insert.row, 0);
        draw(block, map * insert.frame * cell * from_base, own);
      }
    }
    open_blocks_.pop_back();
  }

  const std::filesystem::path& file_;
  DxfGroups dxf_;
  DxfEntity entity_;
  geometry::Affine unit_;
  std::size_t hatches_ = 0;  ///< whose outlines are drawn
  std::string unknown_unit_;
  bool has_unit_ = false, is_imperial_ = false;
  std::set<std::string> frozen_layers_, off_layers_;
  std::map<std::string, Colour> layer_colours_;
  std::set<std::string> not_plotted_layers_{"defpoints"};  ///< that one by definition
  std::set<std::string> named_layers_;                     ///< in the notice
  std::map<std::string, Block> blocks_;
  std::vector<const Block*> open_blocks_;
  bool keeps_texts_;
  std::vector<TextBlock> texts_;
  CurveCollector curves_;
};

}  // namespace

namespace {

LetteredDrawing read(const std::filesystem::path& path, bool keeps_texts) {
  std::string bytes = read_file(path);
  const bool is_binary = is_binary_dxf(bytes);
  if (!is_binary) refuse_utf16(path, bytes);
  if (is_binary) bytes = text_of_binary_dxf(path, bytes);
  return DxfReader(path, bytes, is_binary, keeps_texts).read();
}

}  // namespace

Curves read_dxf(const std::filesystem::path& path) { return read(path, false).curves; }

LetteredDrawing read_dxf_with_texts(const std::filesystem::path& path) { return read(path, true); }

}  // namespace lamplock::model
