// The jobs that the server has run, in the library of its user.
//
// In:  jobs that have ended. Out: records in the library, read back for clients; their reports.
// Who: the server, which writes them outside of its thread and of that of the machine.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "host/run/background.hpp"
#include "host/serve/machine_view.hpp"
#include "host/serve/note.hpp"
#include "host/serve/reports.hpp"

namespace lamplock::serve {

/// Writes jobs into the library, so that neither the server nor the machine waits for a disk.
class History {
 public:
  /// `library` is a file; empty: the user's own.
  History(std::string library, std::string board, Reports reports, Note note)
      : library_(std::move(library)),
        board_(std::move(board)),
        reports_(std::move(reports)),
        note_(std::move(note)) {}

  void add(std::vector<EndedJob> jobs);
  /// To be called regularly.
  void poll();
  /// Writes what is left before it returns.
  void end();

 private:
  void keep(const std::vector<EndedJob>& jobs) const;

  std::string library_, board_;
  Reports reports_;
  Note note_;
  std::vector<EndedJob> unkept_;
  run::Background<bool> writing_;
};

/// The last 100 jobs of a library, newest first, for clients, with the names of their reports.
/// Throws Error(bad_input).
nlohmann::json history_json(const std::string& library, const Reports& reports);

/// The settings of all materials in the library, for clients. Throws Error(bad_input).
nlohmann::json materials_json(const std::string& library);

}  // namespace lamplock::serve
