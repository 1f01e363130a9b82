// Durations for people: the one form of the whole program, its reports and pages.
//
// In:  seconds. Out: "4.72 s", "2 min 03 s", "1 h 02 min 03 s".
// Who: messages, summaries; host/report/page/data.js has the same form.
#pragma once

#include <string>

namespace lamplock {

/// Below a minute with hundredths, otherwise in whole seconds.
std::string duration_text(double seconds);

/// In the form of the longest of several, so that they can be compared: "0 min 40 s".
std::string duration_text(double seconds, double longest);

/// The same without hundredths, rounded up, for a time that is shown while it passes: "12 s".
std::string whole_seconds_text(double seconds);

}  // namespace lamplock
