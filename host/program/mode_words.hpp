// Words of a program that set modes, in millimetres.
//
// In:  a modal state. Out: its words, each with a blank before it where several may follow.
// Who: start_at(), lines_to_restore().
#pragma once

#include <string>

#include "firmware/program/modal.hpp"

namespace lamplock::program_run {

/// " G17 G54"
std::string plane_and_system(const program::Modal& modal);
/// " G61.1", " G64 P0.100"; empty for G61, where a program begins.
std::string path_words(const program::Modal& modal);
/// "F600.000", "G93", "G95 F0.100000"; empty for G94 without F.
std::string feed_words(const program::Modal& modal);
/// "S500.000"
std::string speed_word(const program::Modal& modal);

}  // namespace lamplock::program_run
