// Remarks on standard error while something runs: progress, notes, texts of the machine.
//
// In:  text. Out: standard error, as far as it takes text. Who: progress and notes of all rooms.
// A job that fires must neither end nor wait because a terminal is stopped (Ctrl-S), a pipe is full
// or closed, or a disk is full: such text is left out.
#pragma once

#include <cstdio>
#include <string_view>

namespace lamplock {

/// The stream takes a line now, or fails at once; false if a write would wait.
bool takes_text(std::FILE* stream) noexcept;

/// Writes text with its line end, whole or not at all. Never fails and never waits.
void write_remark(std::string_view text) noexcept;

}  // namespace lamplock
