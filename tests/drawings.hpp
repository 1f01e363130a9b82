// Small DXF drawings as text, for tests of cutting.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace lamplock::test {

/// A corner of a polyline with the bulge of the arc to the next one.
struct DxfCorner {
  double x = 0, y = 0, bulge = 0;
};

inline std::string dxf_polyline(const std::vector<DxfCorner>& corners, bool closed,
                                const std::string& layer = "CUT", int colour = 256) {
  std::string text = fmt::format("0\nLWPOLYLINE\n8\n{}\n62\n{}\n90\n{}\n70\n{}\n", layer, colour,
                                 corners.size(), closed ? 1 : 0);
  for (const DxfCorner& corner : corners)
    text += fmt::format("10\n{}\n20\n{}\n42\n{}\n", corner.x, corner.y, corner.bulge);
  return text;
}

inline std::string dxf_circle(double x, double y, double radius, const std::string& layer = "CUT",
                              int colour = 256) {
  return fmt::format("0\nCIRCLE\n8\n{}\n62\n{}\n10\n{}\n20\n{}\n40\n{}\n", layer, colour, x, y,
                     radius);
}

inline std::string dxf_rectangle(double x, double y, double width, double height,
                                 const std::string& layer = "CUT", int colour = 256) {
  return dxf_polyline({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, true,
                      layer, colour);
}

/// A rectangle whose corners are arcs, drawn clockwise.
inline std::string dxf_rounded(double x, double y, double width, double height, double radius,
                               const std::string& layer = "CUT") {
  const double quarter = -0.41421356237309503;  // the tangent of a quarter of a quarter turn
  const double right = x + width, top = y + height;
  return dxf_polyline({{x, y + radius, 0},
                       {x, top - radius, quarter},
                       {x + radius, top, 0},
                       {right - radius, top, quarter},
                       {right, top - radius, 0},
                       {right, y + radius, quarter},
                       {right - radius, y, 0},
                       {x + radius, y, quarter}},
                      true, layer);
}

/// A drawing of entities in a unit of $INSUNITS: 4 is mm, 1 inch, 0 none.
inline std::string dxf_drawing(const std::string& entities, int units = 4) {
  return fmt::format(
      "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}0\n"
      "ENDSEC\n0\nEOF\n",
      units, entities);
}

}  // namespace lamplock::test
