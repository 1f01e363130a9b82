#include "host/run/cut_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/lettering/font.hpp"
#include "host/lettering/stroke_letters.hpp"
#include "host/lettering/text_curves.hpp"
#include "host/model/colour.hpp"
#include "host/model/input.hpp"
#include "host/model/read_dxf.hpp"
#include "host/model/read_svg.hpp"
#include "host/number_text.hpp"
#include "host/run/file_ways.hpp"
#include "host/suggestion.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using cutting::Fault;
using cutting::FaultKind;

/// "'0', 'cut' and 3 more"
std::string first_few(const std::vector<std::string>& names) {
  constexpr std::size_t max_named = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), max_named); ++i)
    text += fmt::format("{}'{}'", i == 0 ? "" : ", ", names[i]);
  return names.size() <= max_named ? text
                                   : fmt::format("{} and {} more", text, names.size() - max_named);
}

/// The curves and the texts of a drawing.
model::LetteredDrawing read_drawing(const DrawingChoice& drawing) {
  const std::string& file = drawing.file;
  require_drawing_name(file);
  const std::string ending = lower_extension(file);
  if (drawing.text != "none" && (ending == ".dxf" || ending == ".svg")) {
    model::LetteredDrawing read =
        ending == ".dxf" ? model::read_dxf_with_texts(file) : model::read_svg_with_texts(file);
    if (!read.curves.paths.empty() || !read.texts.empty()) return read;
  }
  model::Input input = model::read_input(file);
  auto* curves = std::get_if<model::Curves>(&input);
  if (curves == nullptr || curves->paths.empty())
    throw Error(Exit::bad_input, file, "has points and no curves", "draw lines, arcs or splines");
  return {std::move(*curves), {}};
}

std::unique_ptr<lettering::Letters> letters_of(const DrawingChoice& drawing) {
  if (drawing.text == "stroke") return std::make_unique<lettering::StrokeLetters>();
  return lettering::font_named(drawing.font);
}

/// Adds the letters of texts to the curves of a drawing.
void add_letters(const std::vector<model::TextBlock>& texts, const DrawingChoice& drawing,
                 model::Curves& curves, CutDrawing& result) {
  const bool is_named = drawing.text != "stroke" && drawing.font != DrawingChoice{}.font;
  if (texts.empty() && !is_named) return;
  const std::unique_ptr<lettering::Letters> font = letters_of(drawing);
  if (texts.empty()) return;
  lettering::TextCurves letters = lettering::text_curves(texts, *font);
  for (model::Path& path : letters.paths) curves.paths.push_back(std::move(path));
  result.texts = texts.size();
  result.font = font->name();
  if (letters.missing > 0)
    result.warnings.push_back(fmt::format(
        "{} not in {}: {}",
        count_text(letters.missing, "character of the texts is", "characters of the texts are"),
        result.font, drawing.text == "stroke" ? "use outlines for them" : "give another font"));
}

double mm_of(const std::string& unit) {
  if (unit == "cm") return 10;
  if (unit == "m") return 1000;
  if (unit == "inch") return mm_per_inch;
  return unit == "foot" ? 12 * mm_per_inch : 1;
}

/// The factor from the mm of the reader to those of the user.
double unit_factor(const DrawingChoice& drawing, const model::Curves& curves,
                   const std::string& unknown_unit) {
  if (!drawing.units && curves.has_unit) return 1;
  if (!drawing.units)
    throw Error(Exit::bad_input, drawing.file,
                unknown_unit.empty()
                    ? "the drawing names no unit ($INSUNITS)"
                    : fmt::format("$INSUNITS is {:.20}, not a usable unit of length", unknown_unit),
                "give its unit, mm, cm, m, inch or foot: --units mm, or units = \"mm\" in a "
                "description");
  if (lower_extension(drawing.file) != ".dxf")
    throw Error(Exit::bad_input, drawing.file, "an SVG has units of its own", "leave out the unit");
  return mm_of(*drawing.units) / curves.mm_per_unit;
}

/// Which operation is for which curves.
class Choice {
 public:
  Choice(const CutDescription& description, const model::Curves& curves)
      : description_(description), curves_(curves) {
    for (std::size_t i = 0; i < description.operations.size(); ++i) {
      const OperationChoice& operation = description.operations[i];
      for (const std::string& layer : operation.layers) require_layer(layer, i);
      auto& colours = colours_.emplace_back();
      for (const std::string& text : operation.colours)
        colours.insert(model::colour_named(text).value_or(model::no_colour));
      for (const model::Colour colour : colours) require_colour(colour, i);
    }
  }

  /// The first one whose layers and colours are those of the curve.
  std::optional<std::size_t> of(const model::Path& path) const {
    const std::string& layer = curves_.layers[path.layer];
    for (std::size_t i = 0; i < description_.operations.size(); ++i) {
      const auto& layers = description_.operations[i].layers;
      const bool has_layer =
          layers.empty() || std::find(layers.begin(), layers.end(), layer) != layers.end();
      if (has_layer && (colours_[i].empty() || colours_[i].contains(path.colour))) return i;
    }
    return std::nullopt;
  }

 private:
  void require_layer(const std::string& layer, std::size_t number) const {
    const std::vector<std::string>& all = curves_.layers;
    if (std::find(all.begin(), all.end(), layer) != all.end()) return;
    std::vector<std::string> named = all;
    std::erase(named, "");  // of curves of an SVG outside its layers
    throw Error(Exit::bad_input, operation_name(description_.operations[number], number),
                fmt::format("the drawing has no curves on a layer '{}'", layer),
                did_you_mean(layer, named,
                             named.empty() ? "leave the layer out: it has none"
                                           : "give one of its layers: " + first_few(named)));
  }
  void require_colour(model::Colour colour, std::size_t number) const {
    for (const model::Path& path : curves_.paths)
      if (path.colour == colour) return;
    std::set<std::string> all;
    for (const model::Path& path : curves_.paths)
      if (path.colour != model::no_colour) all.insert(model::colour_text(path.colour));
    throw Error(
        Exit::bad_input, operation_name(description_.operations[number], number),
        fmt::format("the drawing has no curves of the colour {}", model::colour_text(colour)),
        all.empty() ? "leave the colour out: its curves have none"
                    : "give one of its colours: " + first_few({all.begin(), all.end()}));
  }

  const CutDescription& description_;
  const model::Curves& curves_;
  std::vector<std::set<model::Colour>> colours_;
};

bool is_worked(const CutDescription& description, const std::optional<std::size_t>& operation) {
  return operation && !description.operations[*operation].is_off &&
         description.operations[*operation].kind != "ignore";
}

/// Operations that are off count for the place of a drawing: the runs of its operations one after
/// the other fit together.
bool is_placed(const CutDescription& description, const std::optional<std::size_t>& operation) {
  return operation && description.operations[*operation].kind != "ignore";
}

/// The map that puts the edges of what has an operation where the description says.
geometry::Affine place_of(const DrawingChoice& drawing, const model::Curves& placed) {
  if (!drawing.x_mm && !drawing.y_mm) return {};
  const geometry::Bounds box = model::bounds(placed);
  return geometry::moved(drawing.x_mm ? *drawing.x_mm - box.low.x : 0,
                         drawing.y_mm ? *drawing.y_mm - box.low.y : 0, 0);
}

/// Curves that one layer and one operation have in common are joined.
struct JoinGroup {
  std::uint32_t layer = 0;
  std::optional<std::size_t> operation;
  friend auto operator<=>(const JoinGroup&, const JoinGroup&) = default;
};

/// Operations that are on and have no curves, because those before them have taken all of theirs.
void warn_of_idle(const CutDescription& description, const std::vector<JoinGroup>& groups,
                  std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < description.operations.size(); ++i) {
    const bool has_curves = std::any_of(groups.begin(), groups.end(),
                                        [i](const JoinGroup& one) { return one.operation == i; });
    if (has_curves || !is_worked(description, i)) continue;
    warnings.push_back(
        fmt::format("{} has no curves: a curve gets the first operation that its layer and colour "
                    "match",
                    operation_name(description.operations[i], i)));
  }
}

/// The contour goes through the sheet.
bool is_cut(const CutDescription& description, const cutting::Shape& shape) {
  return is_worked(description, shape.operation) &&
         description.operations[*shape.operation].kind == "cut";
}

/// Open ends and crossings are faults of what is cut through. Scores and engravings may have them.
bool matters(const Fault& fault, const CutDescription& description,
             const std::vector<cutting::Shape>& shapes) {
  if (fault.kind == FaultKind::bridged_gap || fault.kind == FaultKind::duplicate ||
      fault.kind == FaultKind::dot)
    return true;
  return (!fault.contour || is_cut(description, shapes[*fault.contour])) &&
         (!fault.other || is_cut(description, shapes[*fault.other]));
}

const char* fault_name(FaultKind kind) {
  switch (kind) {
    case FaultKind::bridged_gap:
      return "closed gap";
    case FaultKind::gap:
      return "open end";
    case FaultKind::duplicate:
      return "duplicate, left out";
    case FaultKind::dot:
      return "curve shorter than the tolerance, left out";
    case FaultKind::self_intersection:
      return "contour that crosses itself";
    case FaultKind::crossing:
      return "crossing of two contours";
    case FaultKind::narrow:
      return "place too narrow for the beam";
    case FaultKind::vanished:
      return "part of a contour smaller than the beam, left out";
    case FaultKind::overlap:
      return "overlap of two contours";
    case FaultKind::beams:
      return "crossing of the beams of two contours, whose material the beam takes there";
    case FaultKind::near:
      return "gap narrower than the beam, which cuts into the contours at both sides of it";
    case FaultKind::unhatched:
      return "contour that no line of the hatch crosses";
    case FaultKind::unfilled:
      return "contour without a fill beside filled ones, not engraved";
  }
  return "";
}

/// What may be joined, and which of it decides where the drawing is placed.
struct GroupedPaths {
  std::vector<JoinGroup> groups;
  model::Curves placed;
};

/// Writes the number of its group into each path in place of its layer. Throws Error(bad_input) if
/// no path has work.
GroupedPaths group_paths(const CutDescription& description, model::Curves& curves) {
  const Choice choice(description, curves);
  std::map<JoinGroup, std::uint32_t> numbers;
  GroupedPaths result;
  bool has_work = false;
  for (model::Path& path : curves.paths) {
    const JoinGroup group{path.layer, choice.of(path)};
    const auto [entry, is_new] =
        numbers.try_emplace(group, static_cast<std::uint32_t>(result.groups.size()));
    if (is_new) result.groups.push_back(group);
    path.layer = entry->second;
    if (is_placed(description, group.operation)) result.placed.paths.push_back(path);
    has_work = has_work || is_worked(description, group.operation);
  }
  if (!has_work)
    throw Error(Exit::bad_input, description.drawing.file,
                "no curve of the drawing has an operation that is on",
                "choose other layers or colours; the option --list shows them");
  return result;
}

cutting::JoinOptions join_options(const CutDescription& description,
                                  const std::vector<JoinGroup>& groups) {
  cutting::JoinOptions options{description.drawing.tolerance_mm, model::flat_mm};
  for (const JoinGroup& group : groups)  // curves without an operation are duplicates of each other
    options.duplicate_groups.push_back(group.operation.value_or(description.operations.size()));
  return options;
}

/// Throws Error(bad_input) if no contour with work is left.
void add_shapes(const CutDescription& description, std::vector<cutting::Contour> contours,
                const std::vector<JoinGroup>& groups, const std::vector<std::string>& layers,
                CutDrawing& result) {
  bool has_work = false;
  for (cutting::Contour& contour : contours) {
    const JoinGroup& group = groups[contour.layer];
    result.layers.push_back(layers[group.layer]);
    result.shapes.push_back({std::move(contour), {}, group.operation});
    has_work = has_work || is_worked(description, group.operation);
  }
  if (!has_work)
    throw Error(Exit::bad_input, description.drawing.file,
                fmt::format("has no curve longer than the tolerance of {} mm to cut",
                            number_text(description.drawing.tolerance_mm)),
                "draw lines, arcs or splines, or use a smaller tolerance");
}

std::string hatch_warning(std::size_t hatches) {
  return fmt::format("{} taken as the outline of its area: to fill it, engrave its layer",
                     hatches == 1 ? "1 HATCH is" : fmt::format("{} HATCHes are each", hatches));
}

}  // namespace

std::vector<std::string> fault_texts(const std::vector<Fault>& faults, double tolerance_mm) {
  // Ends that are nearer than this were to meet.
  constexpr double max_tolerances = 20;
  std::map<FaultKind, std::pair<std::size_t, const Fault*>> kinds;
  for (const Fault& fault : faults) {
    auto& [count, first] = kinds[fault.kind];
    if (count++ == 0) first = &fault;
  }
  std::vector<std::string> texts;
  for (const auto& [kind, found] : kinds) {
    const auto& [count, fault] = found;
    std::string text = fmt::format("{} x {}, the first at ({:.3f}, {:.3f})", grouped(count),
                                   fault_name(kind), fault->at.x, fault->at.y);
    if (kind == FaultKind::gap && fault->size_mm > 0) {
      text += fmt::format(", {} mm from the next open end", number_text(fault->size_mm));
      // Nearer ends are those of other operations, or more than two.
      if (fault->size_mm > tolerance_mm && fault->size_mm <= max_tolerances * tolerance_mm)
        text += ": a greater tolerance joins them";
    } else if (fault->size_mm > 0)
      text += fmt::format(", {} mm", number_text(fault->size_mm));
    texts.push_back(std::move(text));
  }
  return texts;
}

/// Whether all of a path has one height.
bool is_level(const model::Path& path) {
  const double height = model::start_of(path).z;
  const auto is_there = [&](const geometry::Point& p) {
    return std::abs(p.z - height) <= model::flat_mm;
  };
  const auto is_flat = [](const geometry::Point& direction) {
    return std::abs(direction.z) <= model::flat_mm;
  };
  return std::all_of(path.pieces.begin(), path.pieces.end(), [&](const model::Piece& piece) {
    if (const auto* line = std::get_if<model::Line>(&piece))
      return is_there(line->from) && is_there(line->to);
    if (const auto* arc = std::get_if<model::Arc>(&piece))
      return is_there(arc->centre) && is_flat(arc->u) && is_flat(arc->v);
    const auto& poles = std::get<model::Spline>(piece).poles;
    return std::all_of(poles.begin(), poles.end(), is_there);
  });
}

/// What of the drawing is not cut as it is drawn.
void warn_of_rest(model::Curves& curves, std::vector<std::string>& warnings) {
  if (!curves.points.empty()) curves.left_out["POINT"] += curves.points.size();
  if (const std::string rest = model::left_out_text(curves); !rest.empty())
    warnings.push_back(fmt::format("left out: {}", rest));
  const auto tilted = std::count_if(curves.paths.begin(), curves.paths.end(),
                                    [](const model::Path& path) { return !is_level(path); });
  if (tilted > 0)
    warnings.push_back(fmt::format("{} {} not parallel to the XY plane: cut as seen from above",
                                   tilted, tilted == 1 ? "curve is" : "curves are"));
}

void require_drawing_name(const std::string& file) {
  refuse_finished(file);
  if (model::may_hold_only(file, model::InputKind::curves)) return;
  const FileWay way = way_of_file(file);
  throw Error(Exit::bad_input, file,
              way ? way.what + ", not a drawing to cut" : std::string("is not a drawing to cut"),
              "give a drawing: " + model::extensions(model::InputKind::curves));
}

CutDrawing read_cut_drawing(const CutDescription& description) {
  const DrawingChoice& drawing = description.drawing;
  auto [curves, texts, hatches, unknown_unit] = read_drawing(drawing);
  const double factor = unit_factor(drawing, curves, unknown_unit);
  CutDrawing result;
  if (!curves.has_unit) curves.warnings.pop_back();
  result.warnings = curves.warnings;
  warn_of_rest(curves, result.warnings);
  if (hatches > 0) result.warnings.push_back(hatch_warning(hatches));
  add_letters(texts, drawing, curves, result);
  if (curves.paths.empty())
    throw Error(Exit::bad_input, drawing.file, "has no curves and no letters to cut",
                "draw lines, arcs or splines");
  if (factor != 1)
    curves = transformed(std::move(curves), geometry::scaled(factor, factor, factor));
  const auto [groups, placed] = group_paths(description, curves);
  curves = transformed(std::move(curves), place_of(drawing, placed));
  cutting::JoinedContours joined =
      cutting::join_contours(curves, join_options(description, groups));
  std::vector<Fault> faults = std::move(joined.faults);
  const std::vector<Fault> crossings = cutting::contour_faults(joined.contours);
  faults.insert(faults.end(), crossings.begin(), crossings.end());
  warn_of_idle(description, groups, result.warnings);
  add_shapes(description, std::move(joined.contours), groups, curves.layers, result);
  std::erase_if(faults,
                [&](const Fault& fault) { return !matters(fault, description, result.shapes); });
  for (std::string& text : fault_texts(faults, drawing.tolerance_mm))
    result.warnings.push_back(std::move(text));
  return result;
}

}  // namespace lamplock::run
