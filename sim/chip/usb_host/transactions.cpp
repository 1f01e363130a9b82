#include "sim/chip/usb_host/transactions.hpp"

namespace lamplock::sim::chip::usb {

TransactionEngine::TransactionEngine(TimeWheel& wheel, DeviceEnd& device)
    : wheel_(wheel), slot_(wheel.add(*this)), device_(device) {}

void TransactionEngine::start(const Transaction& transaction, Picoseconds at) {
  transaction_ = transaction;
  result_ = {};
  next(Stage::token, at + bit_times(token_bits));
}

void TransactionEngine::abandon() {
  stage_ = Stage::idle;
  plan();
}

void TransactionEngine::plan() {
  wheel_.set(slot_, stage_ == Stage::idle ? never_cycle : wheel_.cycle_at(due_));
}

void TransactionEngine::next(Stage stage, Picoseconds due) {
  stage_ = stage;
  due_ = due;
  plan();
}

void TransactionEngine::finish(std::optional<Pid> answer, Picoseconds end) {
  stage_ = Stage::idle;
  plan();
  result_.answer = answer;
  result_.end = end;
  const Transaction done = transaction_;  // the handler may start another one
  const Result result = result_;
  if (handler_) handler_(done, result);
}

void TransactionEngine::run(Cycle) {
  switch (stage_) {
    case Stage::idle:
      break;
    case Stage::token:
      if (transaction_.token == Pid::in)
        after_in_token();
      else
        after_out_token();
      break;
    case Stage::in_handshake: {
      // The host has accepted good data, even if its ACK is lost.
      const bool good = transaction_.data_fault == Fault::none;
      const Fault fault = transaction_.handshake_fault;
      device_.in_end(good && fault == Fault::none, good ? fault : Fault::none, due_);
      finish(good ? std::optional(result_.data.pid) : std::nullopt, due_ + bit_times(gap_bits));
      break;
    }
    case Stage::out_data:
      after_out_data();
      break;
    case Stage::out_handshake:
      device_.out_end(due_);
      if (transaction_.handshake_fault != Fault::none) handshake_.reset();
      finish(handshake_, due_ + bit_times(gap_bits));
      break;
  }
}

void TransactionEngine::after_in_token() {
  std::optional<Packet> sent;
  if (transaction_.token_fault == Fault::none)
    sent = device_.in(transaction_.address, transaction_.endpoint, due_);
  if (!sent) return finish(std::nullopt, due_ + bit_times(timeout_bits));
  if (sent->pid != Pid::nak && sent->pid != Pid::stall) return after_in_data(*sent);
  const bool heard = transaction_.data_fault == Fault::none;
  finish(heard ? std::optional(sent->pid) : std::nullopt,
         due_ + bit_times(2 * gap_bits + handshake_bits));
}

void TransactionEngine::after_in_data(const Packet& sent) {
  result_.data = sent;
  const Picoseconds data_end = due_ + bit_times(gap_bits + data_bits(sent.size));
  const bool good = transaction_.data_fault == Fault::none;
  next(Stage::in_handshake, data_end + bit_times(good ? gap_bits + handshake_bits : timeout_bits));
}

void TransactionEngine::after_out_token() {
  if (transaction_.token_fault == Fault::none)
    device_.out(transaction_.address, transaction_.endpoint, transaction_.token == Pid::setup,
                due_);
  next(Stage::out_data, due_ + bit_times(gap_bits + data_bits(transaction_.data.size)));
}

void TransactionEngine::after_out_data() {
  handshake_ = device_.out_data(transaction_.data, transaction_.data_fault, due_);
  if (!handshake_) return finish(std::nullopt, due_ + bit_times(timeout_bits));
  next(Stage::out_handshake, due_ + bit_times(gap_bits + handshake_bits));
}

}  // namespace lamplock::sim::chip::usb
