#include "bench/targets/pin_tap.h"

#include <fmt/format.h>

namespace puckloop::exec {

void PinTap::driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven, dspic::Cycle now) {
    PortState& state = ports_[static_cast<std::size_t>(port)];
    const PortState before = state;
    state = {static_cast<std::uint16_t>(levels & driven), driven};
    const unsigned changed = (before.levels ^ state.levels) | (before.driven ^ state.driven);
    for (int bit = 0; bit < 16; ++bit) {
        if (((changed >> bit) & 1u) == 0) continue;
        const char name[] = {'R', static_cast<char>('A' + static_cast<int>(port))};
        std::optional<bool> level;
        if (((driven >> bit) & 1u) != 0) level = ((levels >> bit) & 1u) != 0;
        const cosim::Time time = clock_ != nullptr ? clock_->time_of(now) : 0;
        listener_.pin_changed(fmt::format("{}{}", std::string_view(name, 2), bit), function_of_(port, bit),
                              level, time);
    }
    inner_.driven(port, levels, driven, now);
}

void PinTap::uart_sent(int unit, const cosim::UartFrame& frame) {
    listener_.uart_sent(unit, frame);
    inner_.uart_sent(unit, frame);
}

void PinTap::i2c_phase(int unit, const cosim::I2cPhase& phase) {
    inner_.i2c_phase(unit, phase);
}

void PinTap::i2c_slave_answer(int unit, const cosim::I2cPhase& answer) {
    inner_.i2c_slave_answer(unit, answer);
    if (unit == kI2cScriptUnit) listener_.i2c_answered(answer, dspic::i2c_answer_time(answer));
}

}  // namespace puckloop::exec
