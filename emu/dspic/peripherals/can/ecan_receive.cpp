// ECAN reception: filters and masks, buffers, the FIFO, overflow, answers to remote frames.

#include "emu/dspic/peripherals/can/can_registers.h"
#include "emu/dspic/peripherals/can/ecan.h"
#include "emu/dspic/peripherals/can/ecan_registers.h"

namespace puckloop::dspic {

using namespace ecan;

namespace {

constexpr unsigned kExtension = 18;  // bits of an extended identifier below the standard one
constexpr std::uint32_t kExtensionMask = (1u << kExtension) - 1u;
constexpr int kToFifo = 15;                  // a filter's pointer
constexpr std::uint8_t kRtrEn = 0x04;        // of a control byte
constexpr std::uint8_t kTypeMatters = 0x08;  // MIDE of a mask, EXIDE of a filter

/// Identifier of a filter or mask: SID on top of EID.
std::uint32_t identifier(unsigned sid, unsigned eid) {
    return (sid >> 5 & 0x7FFu) << kExtension | (sid & 3u) << 16 | eid;
}

}  // namespace

bool Ecan::passes(int filter, const CanFrame& frame) const {
    if (!(at(kFen1) >> filter & 1)) return false;
    const unsigned which = at(filter < 8 ? kFmskSel1 : kFmskSel2) >> 2 * (filter % 8) & 3u;
    std::uint32_t cares = 0;
    bool type_matters = false;
    if (which < 3) {
        const int mask = kMask + 4 * static_cast<int>(which);
        cares = identifier(at(mask), at(mask + 2));
        type_matters = at(mask) & kTypeMatters;
    }
    const int place = kFilter + 4 * filter;
    const bool extended = at(place) & kTypeMatters;
    if (type_matters && extended != frame.extended) return false;
    std::uint32_t id = frame.id;
    if (!frame.extended) {
        id <<= kExtension;
        cares &= ~kExtensionMask;
    }
    return ((identifier(at(place), at(place + 2)) ^ id) & cares) == 0;
}

void Ecan::deliver(const CanFrame& frame, Cycle now) {
    for (int filter = 0; filter < kFilters; ++filter) {
        if (mode() != Mode::ListenAll && !passes(filter, frame)) continue;
        const int buffer = at(kBufPnt1 + 2 * (filter / 4)) >> 4 * (filter % 4) & 0xF;
        if (buffer == kToFifo) return store_in_fifo(frame, filter, now);
        if (sends(buffer)) {  // it asks for what this buffer has
            const std::uint8_t control = control_of(buffer);
            if (!frame.remote || !(control & kRtrEn)) return;
            set_control(buffer, control | kTxReq);
            return;
        }
        if (!full(buffer)) return store(buffer, frame, filter, now);
        buffers_.overflowed[0] |= static_cast<std::uint16_t>(1u << buffer);
        return set_flags(kINTF["RBOVIF"], now);
    }
}

void Ecan::store(int buffer, const CanFrame& frame, int filter, Cycle now) {
    Message words{};
    const std::uint32_t standard = frame.extended ? frame.id >> kExtension : frame.id;
    words[0] = static_cast<std::uint16_t>(standard << 2);
    if (frame.extended) {
        words[0] |= 3;  // SRR, IDE
        words[1] = static_cast<std::uint16_t>((frame.id & kExtensionMask) >> 6);
        words[2] = static_cast<std::uint16_t>((frame.id & 0x3Fu) << 10 | (frame.remote ? 0x200 : 0));
    } else if (frame.remote) {
        words[0] |= 2;
    }
    words[2] |= frame.length;
    if (!frame.remote)
        for (std::size_t i = 0; i < frame.length; ++i)
            words[3 + i / 2] |= static_cast<std::uint16_t>(frame.data[i] << (i % 2 ? 8 : 0));
    words[7] = static_cast<std::uint16_t>(filter << 8);
    dma_.block(setup_.receive_irq, static_cast<std::uint16_t>(setup_.base + kRxD),
               static_cast<unsigned>(buffer) * sizeof(Message), words, now);
    around_.interrupts.raise(setup_.receive_irq, now);
    buffers_.full[static_cast<std::size_t>(buffer / 16)] |= static_cast<std::uint16_t>(1u << buffer % 16);
    buffers_.received = static_cast<std::uint8_t>(buffer);
    at(kVec) = static_cast<std::uint16_t>((at(kVec) & ~kVEC["FILHIT"]) | filter << 8);
    set_flags(kINTF["RBIF"], now);
}

// ---- the FIFO, from FSA to the last buffer

int Ecan::fifo_end() const {
    constexpr std::array<int, 8> kSizes{4, 6, 8, 12, 16, 24, 32, 32};
    return kSizes[kFCTRL["DMABS"].of(at(kFctrl))];
}

int Ecan::after(int buffer) const {
    return buffer + 1 < fifo_end() ? buffer + 1 : static_cast<int>(kFCTRL["FSA"].of(at(kFctrl)));
}

void Ecan::store_in_fifo(const CanFrame& frame, int filter, Cycle now) {
    std::uint16_t& pointers = at(kFifo);
    const int buffer = static_cast<int>(kFIFO["FBP"].of(pointers)) % kBuffers;
    if (full(buffer)) {
        buffers_.overflowed[static_cast<std::size_t>(buffer / 16)] |=
            static_cast<std::uint16_t>(1u << buffer % 16);
        return set_flags(kINTF["RBOVIF"], now);
    }
    store(buffer, frame, filter, now);
    const int next = after(buffer);
    pointers = static_cast<std::uint16_t>((pointers & kFIFO["FNRB"]) | next << 8);
    if (full(next) || full(after(next))) set_flags(kINTF["FIFOIF"], now);
}

/// FNRB goes on past buffers that the program has given back.
void Ecan::given_back() {
    std::uint16_t& pointers = at(kFifo);
    const auto of = [&](BitField field) { return static_cast<int>(field.of(pointers)) % kBuffers; };
    int next = of(kFIFO["FNRB"]);
    for (int i = 0; i < kBuffers && !full(next); ++i)
        next = after(next);
    if (!full(next)) next = of(kFIFO["FBP"]);
    pointers = static_cast<std::uint16_t>((pointers & kFIFO["FBP"]) | next);
}

}  // namespace puckloop::dspic
