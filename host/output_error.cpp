#include "host/output_error.hpp"

#include <system_error>

namespace lamplock {

OutputError::OutputError(const std::filesystem::path& file, const std::string& problem)
    : Error(Exit::bad_input, file.string(), problem,
            "give a file name in an existing folder; check permissions and free space"),
      problem_(std::make_shared<const std::string>(problem)) {}

OutputError::OutputError(const std::filesystem::path& file, int error)
    : OutputError(file, "cannot be written (" + std::generic_category().message(error) + ")") {}

}  // namespace lamplock
