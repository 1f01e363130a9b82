// SVG drawings for tests: pages, their lengths and boxes.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "host/geometry/bounds.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/read_svg.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test {

/// A page of 100 x 80 mm in units of mm: (x, y) of the text is (x, 80 - y) of the drawing.
inline std::string svg_page(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" "
         "height=\"80mm\" viewBox=\"0 0 100 80\">\n" +
         content + "\n</svg>\n";
}

class SvgPage : public ::testing::Test {
 protected:
  model::Curves read(const std::string& bytes) {
    return model::read_svg(folder_.write("a.svg", bytes));
  }
  model::Curves shapes(const std::string& content) { return read(svg_page(content)); }
  std::string error(const std::string& content) {
    const auto path = folder_.write("a.svg", svg_page(content));
    return error_of([&] { model::read_svg(path); });
  }
  static double length(const model::Curves& curves) {
    double sum = 0;
    for (const model::Path& path : curves.paths) sum += model::ArcLength(path).total();
    return sum;
  }
  double length(const std::string& content) { return length(shapes(content)); }

  const TemporaryFolder folder_;
};

}  // namespace lamplock::test
