// Whether an interrupt can come: what its source stands at.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/judge/judge.h"
#include "emu/dspic/waits/status_bits.h"

#include <fmt/format.h>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kTxCON{"T?CON"};
constexpr RegisterBits kUxMODE{"U?MODE"};
constexpr RegisterBits kUxSTA{"U?STA"};

bool driven_flag(const WaitContext& chip, int irq) {
    const auto address = static_cast<std::uint16_t>(chip.device.ifs + 2 * (irq / 16));
    const RegisterInfo* info = chip.sfr.info(address);
    return info != nullptr && (driven_bits(chip.device, *info) >> (irq % 16) & 1) != 0;
}

std::string pin_text(const WaitContext& chip, PortLetter port, int bit) {
    const OutsidePin pin = chip.pins.outside(port, bit);
    const std::string name = fmt::format("R{}{}", static_cast<char>('A' + static_cast<int>(port)), bit);
    return pin.function.empty() ? name : fmt::format("{} ({})", name, pin.function);
}

std::optional<std::string> timer_silent(const WaitContext& chip, const TimerPlace& place,
                                        const TimerPlace* lower) {
    // In a pair the lower timer's clock drives both.
    const TimerPlace& counts = lower && chip.sfr.raw(lower->setup.con) & kTxCON["T32"] ? *lower : place;
    const std::uint16_t con = chip.sfr.raw(counts.setup.con);
    if (!(con & kTxCON["TON"])) return fmt::format("T{} is off", counts.number);
    if (!(con & kTxCON["TCS"])) return std::nullopt;
    const std::uint16_t bit = static_cast<std::uint16_t>(1u << counts.clock.number);
    if (chip.ports.changeable(counts.clock.port) & bit) return std::nullopt;
    return fmt::format("T{} counts pin {}, on which nothing changes", counts.number,
                       pin_text(chip, counts.clock.port, counts.clock.number));
}

}  // namespace

std::uint16_t control_register(const WaitContext& chip, int irq) {
    for (const TimerPlace& place : chip.layout.timers)
        if (place.setup.irq == irq) return place.setup.con;
    for (const Uart::Setup& uart : chip.layout.uarts)
        if (uart.rx_irq == irq || uart.tx_irq == irq) return uart.mode;
    return 0;
}

std::optional<std::string> why_silent(const WaitContext& chip, int irq) {
    if (!driven_flag(chip, irq)) return "its source is not modelled";
    const auto timers = chip.layout.timers;
    for (std::size_t i = 0; i < timers.size(); ++i) {
        if (timers[i].setup.irq != irq) continue;
        const bool upper = i + 1 < timers.size() && timers[i + 1].setup.hold != 0 &&
                           timers[i].setup.hold == 0 && timers[i].number == timers[i + 1].number + 1;
        return timer_silent(chip, timers[i], upper ? &timers[i + 1] : nullptr);
    }
    for (const Uart::Setup& uart : chip.layout.uarts) {
        if (uart.rx_irq != irq && uart.tx_irq != irq) continue;
        if (!(chip.sfr.raw(uart.mode) & kUxMODE["UARTEN"])) return fmt::format("UART{} is off", uart.unit);
        const bool empty = chip.sfr.raw(static_cast<std::uint16_t>(uart.mode + 2)) & kUxSTA["TRMT"];
        if (uart.tx_irq == irq && empty) return fmt::format("UART{} has nothing to send", uart.unit);
    }
    return std::nullopt;
}

}  // namespace puckloop::dspic
