#pragma once
// What the ends of a UART that speak to the outside share: bytes that wait for the chip, text that waits for
// the outside.

#include "ends/uart_end.h"

#include <deque>
#include <string>

namespace puckloop::exec {

class QueuedEnd : public UartEnd {
  public:
    cosim::Time next() const override { return incoming_.empty() ? cosim::kNever : ready_; }
    std::uint8_t take() override {
        const std::uint8_t byte = incoming_.front();
        incoming_.pop_front();
        return byte;
    }
    void receive(std::uint8_t byte, bool /*clean*/, cosim::Time /*start*/) override {
        outgoing_ += static_cast<char>(byte);
    }

  protected:
    bool waiting() const { return !incoming_.empty(); }
    /// `count` bytes may be begun from `ready` on.
    void offer(const std::uint8_t* bytes, std::size_t count, cosim::Time ready) {
        incoming_.insert(incoming_.end(), bytes, bytes + count);
        ready_ = ready;
    }

    std::string outgoing_;

  private:
    std::deque<std::uint8_t> incoming_;
    cosim::Time ready_ = 0;
};

}  // namespace puckloop::exec
