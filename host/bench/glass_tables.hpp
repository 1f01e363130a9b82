// Measured productivity of start-stop motion, and fitted step lengths.
//
// Source: "Mechatroniczne pozycjonowanie wiązki lasera impulsowego w urządzeniach do formowania
// obiektów trójwymiarowych w szkle" (Mechatronic positioning of a pulsed laser beam in devices
// forming three-dimensional objects in glass), Białystok University of Technology: 53 measured
// times of one object of 16 179 points. The histogram of step lengths was fitted to these rows
// (lengths along one axis); it is not that of the real object. The published tables are
// tests/data/*.csv; a test compares these with them.
#pragma once

#include <array>

namespace lamplock::bench {

inline constexpr int glass_points = 16'179;

/// One bin of the histogram.
struct StepLength {
  double step_um;
  double fraction;
};

inline constexpr std::array<StepLength, 24> glass_step_lengths{{
    {45, 0.4228},  {56, 0.0840},  {70, 0.0416},  {80, 0.0538},   {94, 0.0353},   {106, 0.0377},
    {119, 0.0306}, {131, 0.0463}, {144, 0.0119}, {156, 0.0278},  {169, 0.0278},  {181, 0.0340},
    {194, 0.0362}, {206, 0.0143}, {231, 0.0147}, {275, 0.0161},  {325, 0.0166},  {375, 0.0139},
    {425, 0.0077}, {475, 0.0087}, {600, 0.0066}, {1000, 0.0102}, {5000, 0.0007}, {20000, 0.0005},
}};

/// One measured run.
struct StartStopTime {
  double lamp_hz, speed_m_s, accel_m_s2, time_s;
};

inline constexpr std::array<StartStopTime, 53> glass_start_stop_times{{
    {50, 0.08, 2, 365},   {50, 0.08, 2.5, 354},  {50, 0.08, 3, 347},   {50, 0.08, 3.5, 342},
    {50, 0.08, 4, 337},   {50, 0.08, 4.5, 335},  {50, 0.08, 5, 331},   {50, 0.08, 5.5, 332},
    {50, 0.08, 6, 331},   {50, 0.08, 6.5, 330},  {50, 0.08, 7, 330},   {50, 0.08, 7.5, 329},
    {50, 0.1, 2, 365},    {50, 0.1, 2.5, 353},   {50, 0.1, 3, 347},    {50, 0.1, 3.5, 341},
    {50, 0.1, 4, 337},    {50, 0.1, 4.5, 334},   {50, 0.1, 5, 332},    {50, 0.1, 5.5, 331},
    {50, 0.1, 6, 330},    {50, 0.1, 6.5, 329},   {50, 0.1, 7, 329},    {50, 0.1, 7.5, 329},
    {100, 0.08, 2, 282},  {100, 0.08, 2.5, 260}, {100, 0.08, 3, 250},  {100, 0.08, 3.5, 238},
    {100, 0.08, 4, 230},  {100, 0.08, 4.5, 221}, {100, 0.08, 5, 215},  {100, 0.08, 5.5, 207},
    {100, 0.08, 6, 204},  {100, 0.08, 6.5, 200}, {100, 0.08, 7, 195},  {100, 0.08, 7.5, 190},
    {100, 0.08, 8, 184},  {100, 0.08, 8.5, 182}, {100, 0.08, 9, 181},  {100, 0.08, 9.5, 179},
    {100, 0.08, 10, 178}, {100, 0.1, 2, 281},    {100, 0.1, 2.5, 260}, {100, 0.1, 3, 249},
    {100, 0.1, 3.5, 238}, {100, 0.1, 4, 230},    {100, 0.1, 4.5, 221}, {100, 0.1, 5, 214},
    {100, 0.1, 5.5, 207}, {100, 0.1, 6, 204},    {100, 0.1, 6.5, 199}, {100, 0.1, 7, 195},
    {100, 0.1, 7.5, 189},
}};

}  // namespace lamplock::bench
