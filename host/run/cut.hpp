// From a drawing to a program that cuts it: contours, operations, compensation, leads, order, and
// the check by the interpreter of the firmware.
//
//   drawing -> contours -> shapes with operations -> plan -> program -> check -> files
//
// In:  a description, names of files to write. Out: the shapes, the files. Nothing is written if
//      anything fails. Who: `cut`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/plan_page.hpp"
#include "host/geometry/bounds.hpp"
#include "host/run/cut_description.hpp"

namespace lamplock::run {

class Frontend;

struct CutRequest {
  CutDescription description{};
  std::string output{}, picture{}, page{}, save{};  ///< empty: none
  std::string library{};                            ///< of materials; empty: the user's own
  std::size_t first =
      1;                ///< number of the first cut of the program, from 1 in the order of the plan
  bool is_dry = false;  ///< the whole program without light and air
  bool is_frame = false;      ///< runs around what is cut instead, without light
  bool is_for_board = false;  ///< refuses a program that is not for a board of lamplock
  bool has_report = false;    ///< of its run
};

/// A contour of the drawing, in the place where it is cut.
struct CutShape {
  std::string layer{}, colour{};  ///< colour: "#rrggbb" or empty
  std::string kind{};             ///< open, outside, hole, island
  std::string direction{};        ///< as it is cut: cw or ccw; empty if open
  double length_mm = 0, area_mm2 = 0;
  geometry::Bounds box{};
  std::string operation{}, operation_kind{};  ///< empty: left out
};

/// The page of a plan, to which the run of its program is added.
struct CutReport {
  cutting::PlanPage page{};
  std::vector<cutting::Operation> operations{};
};

struct CutResult {
  std::vector<CutShape> shapes{};
  std::vector<std::string> warnings{};
  std::size_t cuts = 0;
  double cut_mm = 0, rapid_mm = 0;  ///< with the laser on, between contours; in one pass
  geometry::Bounds box{};           ///< of the program
  std::optional<double> seconds{};  ///< none if the program is not for a board of lamplock
  std::string program{};
  std::vector<std::size_t> cut_numbers{};  ///< of the program, from 1 in the order of the plan
  std::vector<std::size_t> first_lines{};  ///< of each of these cuts, from 1
  CutReport report{};                      ///< empty if it was not requested
};

/// The shapes of the drawing, with the operation of each. Throws Error(bad_input).
CutResult list_shapes(const CutDescription& description, Frontend& frontend);

/// Makes the program and writes the files of the request. Throws Error(bad_input).
CutResult make_cut(const CutRequest& request, Frontend& frontend);

}  // namespace lamplock::run
