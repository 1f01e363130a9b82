// The order of firing, by its name, and told about.
//
// In:  a cloud, an order by name with what it needs to know. Out: the cloud in that order; lines for
//      people. Who: prepare.cpp, `order`.
#pragma once

#include <optional>
#include <string>

#include "host/cli/console.hpp"
#include "host/glass/refraction.hpp"
#include "host/order/order.hpp"
#include "host/points/point.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::cli {

/// Of everything but point lists.
inline constexpr const char* default_order = "best";

/// How points are to be ordered.
struct Ordered {
  std::string name = default_order;
  double half_angle_deg = order::OrderOptions{}.half_angle_deg;
  std::optional<double> layer_mm{};  ///< of orders that have layers
  order::Motion motion{};
};

/// What a machine with these settings can do in a glass: the focus goes further than the stage.
order::Motion motion_of(const settings::Values& values, const glass::Refraction& refraction);

/// Brings points into the order. Throws Error(bad_input).
void order_points(points::PointCloud& cloud, const Ordered& wanted, Console& console);

}  // namespace lamplock::cli
