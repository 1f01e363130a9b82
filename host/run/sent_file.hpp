// What a file for a machine is, by its contents: a job, or a program of G-code.
//
// In:  a file. Out: its kind, or an Error. Who: the commands that send files to a machine or
// predict what they do. The ending of a name is a hint only: a job must never be read as G-code.
#pragma once

#include <string>

#include "host/error.hpp"

namespace lamplock::run {

/// A kind of file that a machine can run.
enum class SentKind { job, program };

/// The kind of a file. Throws Error(bad_input) if it cannot be read or is neither.
SentKind kind_of_sent_file(const std::string& file);

/// The file contains a job. A name that ends in .llj promises one, whatever the file contains.
bool is_job_file(const std::string& file);

/// The name has an ending of programs of G-code.
bool is_program_name(const std::string& file);
/// The name or the first lines of the file are those of a program of G-code.
bool is_program_file(const std::string& file);

/// Throws Error(bad_input) for a file that contains a job, a model or a picture, where a program is
/// read.
void require_program(const std::string& file);

/// The text of a program. Throws Error(bad_input) if it cannot be read or is UTF-16.
std::string read_program_text(const std::string& file);

/// The error for a program without a line to run. `has_flow`: it has O-words.
Error no_line_to_send(const std::string& file, bool has_flow = false);

/// Throws Error(bad_input) for an output whose name does not end in .llj, for a job, or has the
/// ending of another kind of file, for G-code. Devices and pipes have no endings.
void check_job_name(const std::string& output);
void check_program_name(const std::string& output);

}  // namespace lamplock::run
