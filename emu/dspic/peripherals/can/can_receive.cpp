// CAN reception: filters and masks, the two buffers, overflow.

#include "emu/dspic/peripherals/can/can.h"
#include "emu/dspic/peripherals/can/can_registers.h"

namespace puckloop::dspic {

using namespace can;

namespace {
constexpr unsigned kExtension = 18;  // bits of an extended identifier below the standard one
constexpr int kLastOfFirst = 1;  // filters 0 and 1 belong to RXB0 with mask 0, the others to RXB1 with mask 1
constexpr int kLastFilter = 5;
}  // namespace

// The first filter from `first` to `last` that lets the frame pass.
std::optional<int> Can::filter_hit(const CanFrame& frame, int first, int last, int mask) const {
    const int first_of_mask = kMask + kFilterStep * mask;
    const auto identifier = [&](int offset) {
        return (at(offset) >> 2 & 0x7FFu) << kExtension | (at(offset + 2) & 0xFFFu) << 6 |
               (at(offset + 4) >> 10 & 0x3Fu);
    };
    std::uint32_t cares = identifier(first_of_mask);
    const bool type_matters = at(first_of_mask) & 1;  // MIDE
    std::uint32_t id = frame.id;
    if (!frame.extended) {
        id <<= kExtension;
        cares &= ~((1u << kExtension) - 1u);
    }
    for (int filter = first; filter <= last; ++filter) {
        const int offset = kFilter + kFilterStep * filter;
        const bool extended = at(offset) & 1;  // EXIDE
        if (type_matters && extended != frame.extended) continue;
        if (((identifier(offset) ^ id) & cares) == 0) return filter;
    }
    return std::nullopt;
}

void Can::deliver(const CanFrame& frame, Cycle now) {
    std::uint16_t& rx0 = at(kRx + kBufferCon);
    std::uint16_t& rx1 = at(kRx + kBufferStep + kBufferCon);
    if (mode() == Mode::ListenAll) return store(0, frame, 0, now);
    if (const std::optional<int> hit = filter_hit(frame, 0, kLastOfFirst, 0)) {
        if (!(rx0 & kRX0CON["RXFUL"])) return store(0, frame, *hit, now);
        if ((rx0 & kRX0CON["DBEN"]) && !(rx1 & kRX1CON["RXFUL"])) return store(1, frame, *hit, now);
        return set_flags(kRx0Ovr | kErrIf, now);
    }
    const std::optional<int> hit = filter_hit(frame, kLastOfFirst + 1, kLastFilter, 1);
    if (!hit) return;
    if (rx1 & kRX1CON["RXFUL"]) return set_flags(kRx1Ovr | kErrIf, now);
    store(1, frame, *hit, now);
}

void Can::store(int buffer, const CanFrame& frame, int filter, Cycle now) {
    const int base = kRx + kBufferStep * buffer;
    const std::uint32_t standard = frame.extended ? frame.id >> kExtension : frame.id;
    const std::uint32_t extension = frame.extended ? frame.id & ((1u << kExtension) - 1u) : 0;
    unsigned sid = standard << 2;
    if (frame.extended) sid |= kRXSID["RXIDE"] | kRXSID["SRR"];
    if (!frame.extended && frame.remote) sid |= kRXSID["SRR"];
    at(base) = static_cast<std::uint16_t>(sid);
    at(base + 2) = static_cast<std::uint16_t>(extension >> 6);
    at(base + 4) = static_cast<std::uint16_t>((extension & 0x3F) << 10 | frame.length |
                                              (frame.extended && frame.remote ? kRXDLC["RXRTR"] : 0));
    if (!frame.remote)
        for (int i = 0; i < 8; i += 2)
            if (i < frame.length)
                at(base + kData + i) =
                    static_cast<std::uint16_t>(frame.data[static_cast<std::size_t>(i)] |
                                               frame.data[static_cast<std::size_t>(i + 1)] << 8);
    std::uint16_t& con = at(base + kBufferCon);
    const unsigned kept = con & kRX0CON["DBEN"] & (buffer == 0 ? 0xFFFFu : 0u);
    unsigned control = kept | kRX0CON["RXFUL"] | (frame.remote ? kRX0CON["RXRTRRO"] : 0);
    if (buffer == 0)
        control |= static_cast<unsigned>(filter & 1) | (kept >> 1);  // JTOFF mirrors DBEN
    else
        control |= static_cast<unsigned>(filter);
    con = static_cast<std::uint16_t>(control);
    set_flags(static_cast<std::uint16_t>(kRx0If << buffer), now);
}

}  // namespace puckloop::dspic
