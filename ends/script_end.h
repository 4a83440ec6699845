#pragma once
// A UART end that plays a script and keeps what it hears.

#include "ends/scripts.h"
#include "ends/uart_end.h"

#include <vector>

namespace puckloop::exec {

class ScriptEnd : public UartEnd {
  public:
    ScriptEnd() = default;
    explicit ScriptEnd(const std::vector<UartScriptLine>& script) {
        for (const UartScriptLine& line : script)
            send(line.time, line.bytes);
    }
    /// Adds bytes to be begun at `time` or, if that is later, after those already added.
    void send(cosim::Time time, const std::vector<std::uint8_t>& bytes) {
        for (const std::uint8_t byte : bytes)
            outgoing_.push_back({time, byte});
    }
    struct Heard {
        std::uint8_t byte;
        bool clean;
        cosim::Time start;
    };
    const std::vector<Heard>& received() const { return received_; }

    cosim::Time next() const override {
        return position_ < outgoing_.size() ? outgoing_[position_].time : cosim::kNever;
    }
    std::uint8_t take() override { return outgoing_[position_++].byte; }
    void receive(std::uint8_t byte, bool clean, cosim::Time start) override {
        received_.push_back({byte, clean, start});
    }

  private:
    struct Outgoing {
        cosim::Time time;
        std::uint8_t byte;
    };
    std::vector<Outgoing> outgoing_;
    std::size_t position_ = 0;
    std::vector<Heard> received_;
};

}  // namespace puckloop::exec
