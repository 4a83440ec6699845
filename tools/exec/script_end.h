#pragma once
// A UART end that plays a script and keeps what it hears.

#include "tools/exec/scripts.h"
#include "tools/exec/uart_end.h"

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
    const std::vector<std::uint8_t>& received() const { return received_; }
    void clear() { received_.clear(); }

    cosim::Time next() const override {
        return position_ < outgoing_.size() ? outgoing_[position_].time : cosim::kNever;
    }
    std::uint8_t take() override { return outgoing_[position_++].byte; }
    void receive(std::uint8_t byte, bool /*clean*/) override { received_.push_back(byte); }

  private:
    struct Outgoing {
        cosim::Time time;
        std::uint8_t byte;
    };
    std::vector<Outgoing> outgoing_;
    std::size_t position_ = 0;
    std::vector<std::uint8_t> received_;
};

}  // namespace puckloop::exec
