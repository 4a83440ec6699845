// CAN reception: filters and masks, the two buffers, overflow.

#include "emu/dspic/peripherals/can.h"
#include "emu/dspic/peripherals/can_registers.h"

namespace puckloop::dspic {

using namespace can;

namespace {
constexpr unsigned kExtension = 18;  // bits of an extended identifier below the standard one
constexpr int kLastOfFirst = 1;  // filters 0 and 1 belong to RXB0 with mask 0, the others to RXB1 with mask 1
constexpr int kLastFilter = 5;
}  // namespace

bool Can::receive(const CanFrame& frame, Cycle at) {
    const Mode mode = this->mode();
    if (state_.held || mode == Mode::Disable) {
        set_flags(kWakIf, at);
        return false;
    }
    const bool hears = mode == Mode::ListenOnly || mode == Mode::ListenAll || on_bus();
    if (!hears || state_.sending != kNobody) return false;
    state_.bus_free = at + bits(3);
    if (mode == Mode::Normal) {
        std::uint16_t& errors = reg(kEc);
        if (errors & 0xFF) --errors;
    }
    deliver(frame, at);
    if (state_.frame_due != kNoCycle && state_.frame_due < state_.bus_free)
        state_.frame_due = state_.bus_free;
    plan();
    return mode == Mode::Normal;
}

// The first filter from `first` to `last` that lets the frame pass.
std::optional<int> Can::filter_hit(const CanFrame& frame, int first, int last, int mask) const {
    const int at = kMask + kFilterStep * mask;
    const auto identifier = [&](int offset) {
        return (reg(offset) >> 2 & 0x7FFu) << kExtension | (reg(offset + 2) & 0xFFFu) << 6 |
               (reg(offset + 4) >> 10 & 0x3Fu);
    };
    std::uint32_t cares = identifier(at);
    const bool type_matters = reg(at) & 1;  // MIDE
    std::uint32_t id = frame.id;
    if (!frame.extended) {
        id <<= kExtension;
        cares &= ~((1u << kExtension) - 1u);
    }
    for (int filter = first; filter <= last; ++filter) {
        const int offset = kFilter + kFilterStep * filter;
        const bool extended = reg(offset) & 1;  // EXIDE
        if (type_matters && extended != frame.extended) continue;
        if (((identifier(offset) ^ id) & cares) == 0) return filter;
    }
    return std::nullopt;
}

void Can::deliver(const CanFrame& frame, Cycle at) {
    std::uint16_t& rx0 = reg(kRx + kBufferCon);
    std::uint16_t& rx1 = reg(kRx + kBufferStep + kBufferCon);
    if (mode() == Mode::ListenAll) return store(0, frame, 0, at);
    if (const std::optional<int> hit = filter_hit(frame, 0, kLastOfFirst, 0)) {
        if (!(rx0 & kRX0CON["RXFUL"])) return store(0, frame, *hit, at);
        if ((rx0 & kRX0CON["DBEN"]) && !(rx1 & kRX1CON["RXFUL"])) return store(1, frame, *hit, at);
        return set_flags(kRx0Ovr | kErrIf, at);
    }
    const std::optional<int> hit = filter_hit(frame, kLastOfFirst + 1, kLastFilter, 1);
    if (!hit) return;
    if (rx1 & kRX1CON["RXFUL"]) return set_flags(kRx1Ovr | kErrIf, at);
    store(1, frame, *hit, at);
}

void Can::store(int buffer, const CanFrame& frame, int filter, Cycle at) {
    const int base = kRx + kBufferStep * buffer;
    const std::uint32_t standard = frame.extended ? frame.id >> kExtension : frame.id;
    const std::uint32_t extension = frame.extended ? frame.id & ((1u << kExtension) - 1u) : 0;
    unsigned sid = standard << 2;
    if (frame.extended) sid |= kRXSID["RXIDE"] | kRXSID["SRR"];
    if (!frame.extended && frame.remote) sid |= kRXSID["SRR"];
    reg(base) = static_cast<std::uint16_t>(sid);
    reg(base + 2) = static_cast<std::uint16_t>(extension >> 6);
    reg(base + 4) = static_cast<std::uint16_t>((extension & 0x3F) << 10 | frame.length |
                                               (frame.extended && frame.remote ? kRXDLC["RXRTR"] : 0));
    if (!frame.remote)
        for (int i = 0; i < 8; i += 2)
            if (i < frame.length)
                reg(base + kData + i) =
                    static_cast<std::uint16_t>(frame.data[static_cast<std::size_t>(i)] |
                                               frame.data[static_cast<std::size_t>(i + 1)] << 8);
    std::uint16_t& con = reg(base + kBufferCon);
    const unsigned kept = con & kRX0CON["DBEN"] & (buffer == 0 ? 0xFFFFu : 0u);
    unsigned now = kept | kRX0CON["RXFUL"] | (frame.remote ? kRX0CON["RXRTRRO"] : 0);
    if (buffer == 0)
        now |= static_cast<unsigned>(filter & 1) | (kept >> 1);  // JTOFF mirrors DBEN
    else
        now |= static_cast<unsigned>(filter);
    con = static_cast<std::uint16_t>(now);
    set_flags(static_cast<std::uint16_t>(kRx0If << buffer), at);
}

}  // namespace puckloop::dspic
