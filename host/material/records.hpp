// Records of the material library: lasers, materials, settings, measurements.
//
// In:  values from a file of records, a command line or the database. Out: plain structs, and an
//      Error that names the field of a wrong value.
// Who: the library, the fit, the test cards, the use cases of `lamplock material`.
//
// Feeds are in mm/min, as in programs and on the command line; powers are those of the beam in W.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/depth_model.hpp"

namespace lamplock::material {

/// A laser with its optics. Its name is the key.
struct Laser {
  std::int64_t number = 0;  ///< row in the library; 0: not stored
  std::string name;
  double power_w = 0;  ///< of the beam at full power
  std::optional<double> wavelength_nm{};
  std::string beam_shape = "rectangle";  ///< round, rectangle, ellipse
  /// Size of the beam on the material; of round and elliptic beams where the intensity is 1/e of
  /// that in the middle. Without a height it is equal to the width.
  double beam_width_mm = 0;
  std::optional<double> beam_height_mm{};
  std::string note{}, source{};

  cutting::BeamShape beam() const;
  /// A power of the beam in parts of full power, at most 1.
  double share_of(double beam_power_w) const { return std::min(beam_power_w / power_w, 1.0); }
};

/// A material in one colour, and in one thickness if it has one. Its name is the key.
struct Material {
  std::int64_t number = 0;
  std::string name, colour{};
  std::optional<double> thickness_mm{};
  /// What the depth model needs.
  std::optional<double> density_g_cm3{}, specific_energy_kj_g{}, absorption{};
  bool cuttable = true;                      ///< false: it absorbs too little power
  std::optional<double> burn_feed_mm_min{};  ///< its edges burn at this feed and below
  /// What the temperature field needs beside density and absorption.
  std::optional<double> conductivity_w_mk{}, specific_heat_j_gk{}, absorption_per_mm{};
  std::optional<double> emissivity{}, latent_heat_j_g{}, molar_mass_g_mol{}, boiling_k{};
  std::string thermal_source{};
  std::string note{}, source{};
};

/// What a cut needs. Laser, material, thickness and operation are the key.
struct Setting {
  std::int64_t number = 0;
  std::string material, laser;
  std::optional<double> thickness_mm{};  ///< none: of any thickness
  std::string operation = "cut";         ///< cut, score, engrave
  double feed_mm_min = 0, power_w = 0;
  int passes = 1;
  /// Range of good feeds around feed_mm_min.
  std::optional<double> min_feed_mm_min{}, max_feed_mm_min{};
  bool air = false;
  std::optional<double> kerf_mm{};
  std::optional<double> frequency_hz{};  ///< pulses a second; none: the beam is continuous
  std::string note{}, source{};
};

/// A test cut: the depth of its groove, or whether it came through.
struct Measurement {
  std::int64_t number = 0;
  std::string material, laser;
  double feed_mm_min = 0, power_w = 0;
  int passes = 1;
  std::optional<double> depth_mm{}, thickness_mm{};
  std::string result{};   ///< cut, almost, not-cut; empty: the depth was measured
  bool rejected = false;  ///< known to be wrong: not used for fits and best feeds
  std::string note{}, source{};
};

struct Records {
  std::vector<Laser> lasers{};
  std::vector<Material> materials{};
  std::vector<Setting> settings{};
  std::vector<Measurement> measurements{};
};

/// The name of a kind of record, as tables of files, tables of the library and users call it.
template <class Record>
constexpr const char* kind_of();
template <>
constexpr const char* kind_of<Laser>() {
  return "laser";
}
template <>
constexpr const char* kind_of<Material>() {
  return "material";
}
template <>
constexpr const char* kind_of<Setting>() {
  return "setting";
}
template <>
constexpr const char* kind_of<Measurement>() {
  return "measurement";
}

/// Throws Error(bad_input), at `where`, that names the field that is wrong: out of range, not one
/// of the names, missing, or at odds with another field.
void check_record(const Laser& laser, const std::string& where);
void check_record(const Material& material, const std::string& where);
void check_record(const Setting& setting, const std::string& where);
void check_record(const Measurement& measurement, const std::string& where);

}  // namespace lamplock::material
