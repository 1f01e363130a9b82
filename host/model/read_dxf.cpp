#include "host/model/read_dxf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "host/file.hpp"
#include "host/model/curve_collector.hpp"
#include "host/model/dxf_entities.hpp"
#include "host/model/dxf_groups.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

// Nested blocks; drawings have a handful of levels.
constexpr std::size_t deepest_block = 64;

/// A drawn item, with its name for errors.
struct Item {
  std::variant<Path, Point, DxfInsert> what;
  std::string layer;
  FilePosition place;
};

struct Block {
  Point base;
  std::vector<Item> items;
  std::map<std::string, std::size_t> left_out;
};

/// Names of layers and blocks do not distinguish cases.
std::string key(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return lower;
}

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
  DxfReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), dxf_(file, bytes) {}

  Curves read() {
    while (true) {
      dxf_.next_entity(entity_);
      if (entity_.kind == "EOF") return std::move(curves_).finished(file_);
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
      if (variable != "$INSUNITS" || group.code != 70) continue;
      const double mm = mm_in_unit(dxf_.integer(group));
      if (mm == 0)
        dxf_.position_of(group.value)
            .refuse(fmt::format("$INSUNITS is {:.20}, not a usable unit of length", group.value),
                    "set the drawing's unit to mm");
      unit_ = geometry::scaled(mm, mm, mm);
    }
  }

  void read_table_entry() {
    constexpr int frozen = 1;
    if (entity_.kind != "LAYER") return;
    // A layer that is off has a negative colour.
    if ((dxf_.integer(entity_, 70) & frozen) != 0 || dxf_.integer(entity_, 62) < 0)
      hidden_layers_.insert(key(dxf_.text(entity_, 2)));
  }

  void read_block() {
    if (entity_.kind != "BLOCK") return;
    Block block;
    block.base = dxf_.point(entity_, 10);
    const std::string name = key(dxf_.text(entity_, 2));
    while (next_in_section() && entity_.kind != "ENDBLK") read_item(block);
    blocks_.insert_or_assign(name, std::move(block));
  }

  void read_entities() {
    Block one;
    while (next_in_section()) {
      one.items.clear();
      one.left_out.clear();
      read_item(one);
      draw(one, unit_, "0");
    }
  }

  /// Appends entity_, with the entities that belong to it.
  void read_item(Block& block) {
    constexpr int on_paper = 67, is_invisible = 60;
    Item item{{}, std::string(dxf_.text(entity_, 8, "0")), dxf_.position_of(entity_.kind)};
    const std::string kind(entity_.kind);
    const bool paper = dxf_.integer(entity_, on_paper) == 1;
    const bool invisible = dxf_.integer(entity_, is_invisible) == 1;
    if (kind == "SEQEND") return;
    if (!read_shape(item)) {
      ++block.left_out[kind == "SPLINE" ? "SPLINE without poles" : kind];
    } else if (paper || invisible) {
      ++block.left_out[paper ? "paper space" : "hidden"];
    } else {
      block.items.push_back(std::move(item));
    }
  }

  bool read_shape(Item& item) {
    if (entity_.kind == "POLYLINE") return read_polyline(item);
    if (entity_.kind == "POINT") {
      item.what = dxf_.point(entity_, 10);
    } else if (entity_.kind == "INSERT") {
      item.what = dxf_insert(dxf_, entity_);
    } else if (auto path = dxf_path(dxf_, entity_)) {
      item.what = std::move(*path);
    } else {
      return false;
    }
    return true;
  }

  bool read_polyline(Item& item) {
    std::vector<DxfEntity> vertices;
    while (dxf_.peek().value == "VERTEX") dxf_.next_entity(vertices.emplace_back());
    if (is_dxf_surface(dxf_, entity_)) return false;
    item.what = dxf_polyline(dxf_, entity_, vertices);
    return true;
  }

  /// Items on layer 0 of a block get the layer of the block.
  void draw(const Block& block, const geometry::Affine& map, const std::string& layer_of_block) {
    for (const auto& [name, count] : block.left_out) curves_.leave_out(name, count);
    for (const Item& item : block.items) {
      const std::string& layer = item.layer == "0" ? layer_of_block : item.layer;
      if (hidden_layers_.contains(key(layer))) {
        curves_.leave_out("hidden");
      } else if (const auto* path = std::get_if<Path>(&item.what)) {
        curves_.add(*path, map, layer, item.place);
      } else if (const auto* point = std::get_if<Point>(&item.what)) {
        curves_.add(*point, map, item.place);
      } else {
        draw_copies(std::get<DxfInsert>(item.what), map, layer, item.place);
      }
    }
  }

  void draw_copies(const DxfInsert& insert, const geometry::Affine& map, const std::string& layer,
                   const FilePosition& place) {
    const auto found = blocks_.find(key(insert.block));
    if (found == blocks_.end())
      place.refuse(fmt::format("there is no block '{:.40}'", insert.block), "repair the drawing");
    const Block& block = found->second;
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
        curves_.spend(1, place);
        const geometry::Affine cell = geometry::moved(column * insert.column, row * insert.row, 0);
        draw(block, map * insert.frame * cell * from_base, layer);
      }
    }
    open_blocks_.pop_back();
  }

  const std::filesystem::path& file_;
  DxfGroups dxf_;
  DxfEntity entity_;
  geometry::Affine unit_;
  std::set<std::string> hidden_layers_;
  std::map<std::string, Block> blocks_;
  std::vector<const Block*> open_blocks_;
  CurveCollector curves_;
};

}  // namespace

Curves read_dxf(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  return DxfReader(path, bytes).read();
}

}  // namespace lamplock::model
