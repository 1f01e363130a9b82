// Turns a model, or all objects of a description, into a point list; orders a point list.
//
// In:  a request or a point list. Out: a file of points. Who: `points`, `order`.
#pragma once

#include <string>

#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

class Frontend;
struct Cloud;
struct JobRequest;

/// Makes the points of a request and writes them. Throws Error(bad_input).
Cloud make_points(const JobRequest& request, const std::string& output, Frontend& frontend);

struct OrderRequest {
  std::string input{}, output{};
  MachineOptions machine{};
  std::string order{};  ///< its name
  glass::OrderChoice choice{};
};

/// Brings a point list into an order and writes it; returns the points. Throws Error(bad_input).
geometry::PointCloud order_point_list(const OrderRequest& request, Frontend& frontend);

}  // namespace lamplock::run
