// Hands a data structure to another core and back without locks; the core works on it in slices.
//
// In:  the asker (main loop) fills the data, hands it out, and may recall it at any time without
//      waiting; the worker (another core, or the same thread) runs slices.
// Out: ownership. The asker owns the data while it is at home, the worker only during a slice that
//      was asked for. Complete data comes home by a recall.
//
// Three words, each with one writer: the core has no exclusive accesses. The worker sets at_work
// before it reads asked, and the asker clears asked before it reads at_work; with both in sequence
// (a barrier between store and load) at least one sees the other. Data written before a store is
// visible to every reader of the stored value.
//
//   asker    hand_out   recall           recall and fill again        recall
//   asked    | n        | 0              | n + 1                      | 0
//   worker       slices ... slice >|       slices ...   last slice >|
//   at home  no ................... | yes | no ......................  | yes
//
// With one thread no slice runs while the asker looks: recalled data is at home. On the board the
// data is one plan: job_runner.hpp lists what belongs to it.
#pragma once

#include <cstdint>

namespace lamplock::machine {

/// Hands one item between two owners.
class WorkExchange {
 public:
  // The asker.
  /// The item may be worked on from now on.
  void hand_out() {
    number_ += 2;  // always odd: never 0
    store(asked_, number_);
  }
  /// The item is not needed any more; a slice in progress runs to its end.
  void recall() { store(asked_, 0); }
  /// Handed out and not recalled.
  bool asked() const { return asked_ != 0; }
  /// Completed, not recalled: the asker may read it, and the worker does not change it.
  bool complete() const { return asked() && load(answered_) == asked_ && load(at_work_) == 0; }
  /// The asker owns the item.
  bool is_owned() const { return !asked() && load(at_work_) == 0; }

  // The worker.
  /// `work()` runs a slice and returns false with the last one. False if there is nothing more to
  /// do.
  template <class Work>
  bool slice(Work&& work) {
    store(at_work_, 1);
    const std::uint32_t asked = load(asked_);
    bool more = false;
    if (asked != 0 && asked != answered_) {
      more = work();
      if (!more) store(answered_, asked);
    }
    store(at_work_, 0);
    return more;
  }

  // Either.
  /// There is work to do, and no slice runs.
  bool waits() const { return load(at_work_) == 0 && load(asked_) != 0 && !complete(); }
  /// A slice runs or is due.
  bool busy() const { return load(at_work_) != 0 || (load(asked_) != 0 && !complete()); }

 private:
  using Word = std::uint32_t;
  static void store(Word& word, Word value) { __atomic_store_n(&word, value, __ATOMIC_SEQ_CST); }
  static Word load(const Word& word) { return __atomic_load_n(&word, __ATOMIC_SEQ_CST); }

  Word asked_ = 0;     ///< written by the asker: number of the requested item, 0 = none
  Word number_ = 1;    ///< only of the asker: number last handed out
  Word at_work_ = 0;   ///< written by the worker: in a slice
  Word answered_ = 0;  ///< written by the worker: number of what it completed last
};

}  // namespace lamplock::machine
