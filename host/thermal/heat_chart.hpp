// Charts of temperatures as SVG: curves in panels side by side.
//
// In:  curves. Out: text of an SVG file. Who: the pictures of `lamplock heat`.
//
// Colours are those of Okabe and Ito, which colour-blind people can distinguish.
#pragma once

#include <string>
#include <vector>

namespace lamplock::thermal {

struct Curve {
  std::string name{};
  std::vector<double> x{}, y{};
};
struct ChartPanel {
  std::string x_name{}, y_name{};
  std::vector<Curve> curves{};  ///< at most 6 have colours of their own
};

/// `title` is plain text.
std::string heat_chart(const std::vector<ChartPanel>& panels, const std::string& title);

}  // namespace lamplock::thermal
