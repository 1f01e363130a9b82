// The error of a job that the board refuses because of a setting.
//
// In:  the answer of the board to BEGIN. Out: an error with the number of the setting.
// Who: JobSender throws it; host/run/setting_refusal.cpp explains it with the values of the board.
#pragma once

#include <cstdint>
#include <string>

#include "host/error.hpp"

namespace lamplock::link {

class RefusedSetting : public Error {
 public:
  /// `number`: of the setting that the board has named; 0: it has only found that the settings of
  /// the job are not its own.
  RefusedSetting(std::uint32_t number, const std::string& where, const std::string& what,
                 const std::string& remedy)
      : Error(Exit::bad_input, where, what, remedy), number_(number) {}
  std::uint32_t number() const { return number_; }

 private:
  std::uint32_t number_;
};

}  // namespace lamplock::link
