// Brings points into an order of firing by its name, and reports the result.
//
// In:  a cloud, an order by name with what it needs to know. Out: the cloud in that order; a line
//      for people, warnings. Who: prepare.cpp, `order`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/glass/refraction.hpp"
#include "host/order/order.hpp"
#include "host/run/frontend.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// Of everything but point lists.
inline constexpr const char* default_order = "best";

/// What a machine with these settings can do in a glass: the focus goes further than the stage.
order::Motion motion_of(const settings::Values& values, const glass::Refraction& refraction);

/// What an order is to keep to: what was said about it, and the machine. `layer_mm`: of the points,
/// if they have layers.
order::OrderOptions order_options(const glass::OrderChoice& choice, std::optional<double> layer_mm,
                                  const order::Motion& motion);

/// Brings points into an order by its name, and returns warnings: an order that is not changed may
/// engrave points before others that they shadow. Throws Error(bad_input).
std::vector<std::string> order_points(geometry::PointCloud& cloud, const std::string& name,
                                      order::OrderOptions options, Frontend& frontend);

}  // namespace lamplock::run
