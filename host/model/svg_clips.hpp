// Clip paths and simple masks of an SVG as regions (W3C, "CSS Masking Module Level 1").
//
// In:  an element with the properties clip-path and mask, its map to mm.
// Out: the regions that it is visible in.
// Who: read_svg().
//
// Clip paths consist of shapes and uses of shapes, with their rules, transforms and own clip paths.
// Masks have groups, symbols and nested svg, too. A mask is a region if all its shapes are filled
// with opaque white (or, with mask-type: alpha, with any opaque colour) and have no stroke. Others
// cannot be applied.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "host/geometry/affine.hpp"
#include "host/geometry/bounds.hpp"
#include "host/model/clip.hpp"
#include "host/model/svg_document.hpp"
#include "host/model/svg_paint.hpp"
#include "host/model/svg_values.hpp"

namespace lamplock::model {

class SvgClips {
 public:
  explicit SvgClips(const SvgDocument& document) : document_(document) {}

  /// The place of an element: its map to mm, the units in it, its box in its own units if known.
  struct Frame {
    geometry::Affine map;
    SvgUnits units;
    std::optional<geometry::Bounds> box;
  };
  /// True if the clip path or mask of an element, or one that clips these, refers to its box.
  bool needs_box(const pugi::xml_node& node) const;

  /// Appends the regions of an element's own clip path and mask. False if one of them cannot be
  /// applied. Throws Error (bad_input) for a clip path that contains itself, invalid shapes, and by
  /// the limits of ClipWork.
  bool append(const pugi::xml_node& node, const Frame& frame, ClipRegions& regions);

  /// Appends a rectangle, such as the view port of a nested svg.
  void append(const SvgBox& box, const geometry::Affine& map, const FilePosition& place,
              ClipRegions& regions);

  ClipWork& work() { return work_; }

 private:
  using Shapes = std::vector<ClipShape>;
  using Region = std::shared_ptr<const ClipRegion>;
  /// What the shapes of a clip path inherit.
  struct Inherited {
    Frame frame{};
    SvgPaint paint{};
    std::string_view rule{};  ///< fill-rule of a mask, clip-rule of a clip path
    ClipRegions clips{};
    bool is_mask = false, is_alpha = false;
    int depth = 0;
  };

  Region region_of(const pugi::xml_node& element, const Frame& frame, bool is_mask);
  Region new_region(const pugi::xml_node& element, Frame frame, bool is_mask);
  bool append_mask_box(const pugi::xml_node& mask, const Frame& frame, ClipRegions& regions);
  void inherit(const pugi::xml_node& node, Inherited& inherited) const;
  bool enter(const pugi::xml_node& node, Inherited& inherited);
  static bool is_hidden(const pugi::xml_node& node, const Inherited& inherited);
  bool add_children(const pugi::xml_node& node, const Inherited& inherited, Shapes& shapes);
  bool add_element(const pugi::xml_node& node, Inherited inherited, Shapes& shapes);
  bool add_use(const pugi::xml_node& node, Inherited inherited, Shapes& shapes);
  /// Adds what is in an svg, or in a symbol or svg that `use` refers to.
  bool add_view(const pugi::xml_node& node, const pugi::xml_node& use, Inherited inherited,
                Shapes& shapes);
  bool add_shape(const pugi::xml_node& node, Inherited inherited, Shapes& shapes);

  struct Known {
    geometry::Affine map;
    Region region;
  };
  const SvgDocument& document_;
  ClipWork work_;
  std::vector<pugi::xml_node> open_;  ///< being read, against circles
  std::unordered_map<std::size_t, Known> known_;
};

}  // namespace lamplock::model
