#include "host/run/cut_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "host/number_text.hpp"

namespace lamplock::run {
namespace {

using cutting::Compensation;
using cutting::Operation;
using cutting::OperationKind;
using cutting::Shape;

/// The place in the tree decides on which side of the contour its beam or its leads are.
bool uses_place(const Operation& operation) {
  if (operation.kind != OperationKind::cut) return false;
  const bool has_side = operation.compensation == Compensation::automatic ||
                        operation.compensation == Compensation::controller;
  const bool has_leads = operation.lead_in.shape != cutting::LeadShape::none ||
                         operation.lead_out.shape != cutting::LeadShape::none;
  return (has_side && operation.kerf_mm > 0) ||
         (operation.compensation == Compensation::none && has_leads);
}

/// Scores and engravings have trees of their own.
bool is_of_cuts(const Shape& shape, const CutDescription& description) {
  if (!shape.operation) return true;
  const std::string& kind = description.operations[*shape.operation].kind;
  return kind == "cut" || kind == "ignore";
}

/// The numbers of cut contours that are a part instead of a hole, or a hole instead of a part, in
/// the tree of all contours that are not scored or engraved.
std::vector<std::size_t> other_places(const std::vector<Shape>& shapes,
                                      const std::vector<Operation>& operations,
                                      const CutDescription& description) {
  std::vector<Shape> all;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!is_of_cuts(shapes[i], description)) continue;
    all.push_back({shapes[i].contour, {}, std::nullopt});
    numbers.push_back(i);
  }
  cutting::place_shapes(all, {});
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Shape& shape = shapes[numbers[i]];
    if (shape.operation && shape.contour.closed && uses_place(operations[*shape.operation]) &&
        is_part(shape.place) != is_part(all[i].place))
      found.push_back(numbers[i]);
  }
  return found;
}

}  // namespace

void place_cut_shapes(std::vector<Shape>& shapes, const CutDescription& description) {
  std::vector<Operation> operations;
  operations.reserve(description.operations.size());
  for (std::size_t i = 0; i < description.operations.size(); ++i) {
    OperationChoice choice = description.operations[i];
    choice.is_off = false;
    operations.push_back(bare_operation(choice, operation_name(choice, i)));
  }
  cutting::place_shapes(shapes, operations);
}

std::vector<std::string> place_warnings(const std::vector<Shape>& shapes,
                                        const std::vector<Operation>& operations,
                                        const CutDescription& description) {
  const bool are_all_counted = std::ranges::none_of(shapes, [&](const Shape& shape) {
    return !shape.operation || description.operations[*shape.operation].kind == "ignore";
  });
  if (are_all_counted) return {};
  struct Found {
    std::size_t count = 0, first = 0;
  };
  std::map<std::pair<std::size_t, bool>, Found> groups;  // by operation; true: parts
  for (const std::size_t i : other_places(shapes, operations, description)) {
    Found& group = groups[{*shapes[i].operation, is_part(shapes[i].place)}];
    if (group.count++ == 0) group.first = i;
  }
  std::vector<std::string> texts;
  for (const auto& [key, group] : groups) {
    const auto& [operation, are_parts] = key;
    texts.push_back(fmt::format(
        "{}: {} cut as {}, the first is the {}: contours around them that are ignored or have no "
        "operation do not count; if they are {}, give compensation {}",
        operations[operation].name,
        group.count == 1 ? "1 contour is" : count_text(group.count, "contour") + " are",
        are_parts ? "parts" : "holes", contour_text(shapes[group.first].contour),
        are_parts ? "holes" : "parts", are_parts ? "inside" : "outside"));
  }
  return texts;
}

}  // namespace lamplock::run
