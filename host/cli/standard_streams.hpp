// Standard input, output and error of the program: never a file of its own, and no loss unnoticed.
//
// In:  the descriptors 0 to 2 at the start; text for stdout and stderr. Out: the exit status when
// text was lost. Who: program_main(), the console.
#pragma once

#include <cstdio>
#include <string_view>

namespace lamplock::cli {

/// Opens those of the descriptors 0 to 2 that the caller has closed, so that writes to them fail.
/// Otherwise the next port or file would become stdout, and text for the user would be sent to the
/// machine. Failures of std::cout are noticed from then on.
void prepare_streams();

/// Writes and flushes text. A failure does not end the program, because a job must not stop for it;
/// check_output() reports it, or require_output().
void write_text(std::FILE* stream, std::string_view text);

/// Flushes stdout. Returns `status`, or job_failed instead of done if text was lost, with an error
/// on stderr. A reader that has seen enough (`| head`) needs no message.
int check_output(int status);

/// Throws Error (job_failed) if text for stdout was lost so far.
void require_output();

}  // namespace lamplock::cli
