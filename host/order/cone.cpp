#include "host/order/cone.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "host/error.hpp"

namespace lamplock::order {

double cone_tangent(double half_angle_deg) {
  if (!(half_angle_deg >= 0 && half_angle_deg < 90)) {
    throw Error(Exit::bad_input, "order",
                fmt::format("the half angle of the cone is {} degrees", half_angle_deg),
                "give a number from 0 to less than 90");
  }
  return std::tan(half_angle_deg * std::numbers::pi / 180);
}

}  // namespace lamplock::order
