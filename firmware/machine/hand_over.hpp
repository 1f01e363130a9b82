// Something worked on by another core, slice by slice, handed there and back without locks.
//
// In:  the asker (main loop of the machine) hands out what it has filled, and may recall it at any
//      time, without waiting; the worker (another core, or the same thread) does slices.
// Out: who may touch it. The asker while it is at home; the worker during a slice of what is asked
//      for, and at no other time. Complete, it comes home by being recalled.
//
// Three words, each with one writer: the core has no exclusive accesses. The worker says that it is
// at work before it looks whether that is asked for, and the asker recalls before it looks whether
// somebody is at work; with both in sequence (a barrier between store and load) at least one sees
// the other. What is written to before a store is seen by whoever sees that store.
//
//   asker    hand_out   recall           recall and fill again        recall
//   asked    | n        | 0              | n + 1                      | 0
//   worker       slices ... slice >|       slices ...   last slice >|
//   at home  no ................... | yes | no ......................  | yes
//
// With one thread no slice is ever under way when the asker looks: what is recalled is at home.
// On the board it is one plan: job_runner.hpp says what belongs to it.
#pragma once

#include <cstdint>

namespace lamplock::machine {

/// Passes one thing between two.
class HandOver {
 public:
  // The asker.
  /// What is at home may be worked on from now on.
  void hand_out() {
    number_ += 2;  // always odd: never 0
    store(asked_, number_);
  }
  /// It is not wanted any more; a slice under way goes on to its end.
  void recall() { store(asked_, 0); }
  /// Handed out and not recalled.
  bool asked() const { return asked_ != 0; }
  /// Worked on to its end, not recalled: the asker may look at it, and nobody will change it.
  bool complete() const { return asked() && load(answered_) == asked_ && load(at_work_) == 0; }
  /// The asker may do with it what it likes.
  bool at_home() const { return !asked() && load(at_work_) == 0; }

  // The worker.
  /// `work()` does a slice and returns false with the last one. False if there is nothing more to
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
  /// There is something to do, and nobody is at it.
  bool waits() const { return load(at_work_) == 0 && load(asked_) != 0 && !complete(); }
  /// Somebody is at work, or ought to be.
  bool busy() const { return load(at_work_) != 0 || (load(asked_) != 0 && !complete()); }

 private:
  using Word = std::uint32_t;
  static void store(Word& word, Word value) { __atomic_store_n(&word, value, __ATOMIC_SEQ_CST); }
  static Word load(const Word& word) { return __atomic_load_n(&word, __ATOMIC_SEQ_CST); }

  Word asked_ = 0;     ///< written by the asker: number of what is wanted, 0 = nothing
  Word number_ = 1;    ///< the asker's own: of what was handed out last
  Word at_work_ = 0;   ///< written by the worker: in a slice
  Word answered_ = 0;  ///< written by the worker: number of what it completed last
};

}  // namespace lamplock::machine
