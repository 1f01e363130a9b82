// Records of the material library as lines for people and as JSON.
//
// In:  records. Out: one line or one JSON object for each. Who: `lamplock material`.
#pragma once

#include <string>

#include "host/cli/json.hpp"
#include "host/material/depth_fit.hpp"
#include "host/material/records.hpp"

namespace lamplock::cli {

/// All fields of a record by their keys, null where there is no value.
template <class Record>
Json record_json(Record record);

std::string line_of(const material::Laser& laser);
std::string line_of(const material::Material& material);
std::string line_of(const material::Setting& setting);
std::string line_of(const material::Measurement& measurement);

/// "B 0.67018  w 0.90940  rms 0.177".
std::string fit_text(const material::MaterialFit& fit);
Json fit_json(const material::MaterialFit& fit);
Json best_json(const material::BestCut& best);

}  // namespace lamplock::cli
