#include "emu/dspic/peripherals/can/ecan.h"

#include "emu/dspic/peripherals/can/can_registers.h"
#include "emu/dspic/peripherals/can/ecan_registers.h"

#include <algorithm>
#include <bit>

namespace puckloop::dspic {

using namespace ecan;

namespace {

constexpr std::uint16_t kTbIf = kINTF["TBIF"], kRbIf = kINTF["RBIF"], kRbOvIf = kINTF["RBOVIF"],
                        kFifoIf = kINTF["FIFOIF"];
constexpr std::uint16_t kClearable = 0xFF;
constexpr unsigned kByteBits = 8, kIdBits = 18;
constexpr std::uint8_t kTxEn = 0x80;                            // of a control byte
constexpr std::uint8_t kWritable = kTxEn | 0x08 | 0x04 | 0x03;  // TXEN, TXREQ, RTREN, TXPRI

CanLine::Place place_of(const Ecan::Setup& setup) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup.base + offset); };
    return {.unit = setup.unit,
            .ctrl = at(kCtrl1),
            .cfg1 = at(kCfg1),
            .cfg2 = at(kCfg2),
            .intf = at(kIntf),
            .inte = at(kInte),
            .ec = at(kEc),
            .irq = setup.irq,
            .port = setup.port,
            .rx = setup.rx,
            .tx = setup.tx,
            .clock_quarters = 2,  // FCAN is FOSC, twice FCY, or FCY
            .clock_quarters_set = 4,
            .transmitters = 8};
}

}  // namespace

Ecan::Ecan(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
           Pins& pins, Dma& dma)
    : CanLine(around, place_of(setup), clock, ports, pins), setup_(setup), dma_(dma) {
    const auto hook = [&](int offset, ReadHook read, WriteHook write) {
        around_.sfr.hook(static_cast<std::uint16_t>(setup_.base + offset), this, read, write);
    };
    hook(kCtrl1, nullptr, write_control);
    hook(kVec, nullptr, write_nothing);
    hook(kFifo, nullptr, write_nothing);
    hook(kFctrl, nullptr, write_fifo);
    for (const int offset : {kIntf, kInte, kEc})
        hook(offset, nullptr, write_interrupts);
    for (const int offset : {kCfg1, kCfg2})
        hook(offset, nullptr, write_timing);
    for (const int offset : {kCtrl2, kFen1, kFmskSel1, kFmskSel2})
        around_.sfr.claim(static_cast<std::uint16_t>(setup_.base + offset));
    for (int offset = kWindow; offset < kWindowEnd; offset += 2)
        if (const auto address = static_cast<std::uint16_t>(setup_.base + offset);
            around_.sfr.info(address)) {
            hook(offset, read_window, write_window);
            around_.sfr.hook_quiet(address, this, read_window);
        }
    for (const int offset : {kRxD, kTxD})
        dma_.serve_blocks(static_cast<std::uint16_t>(setup_.base + offset));
}

void Ecan::reset() {
    reset_line();
    buffers_ = {};
}

// ---- windows

/// A register of window 0 that is no plain storage; null: it is of window 1, or none.
std::uint16_t* Ecan::of_buffers(int offset) {
    const auto word = [&](auto& words, int first) -> std::uint16_t* {
        const int index = (offset - first) / 2;
        return offset >= first && index < static_cast<int>(words.size())
                   ? &words[static_cast<std::size_t>(index)]
                   : nullptr;
    };
    if (std::uint16_t* const full = word(buffers_.full, kRxFul1)) return full;
    if (std::uint16_t* const overflowed = word(buffers_.overflowed, kRxOvf1)) return overflowed;
    return word(buffers_.control, kTr01Con);
}

std::uint16_t Ecan::read_window(void* owner, std::uint16_t address) {
    Ecan& self = *static_cast<Ecan*>(owner);
    if (self.at(kCtrl1) & kCTRL1["WIN"]) return self.reg(address);
    const std::uint16_t* const word = self.of_buffers(address - self.setup_.base);
    return word ? *word : std::uint16_t{0};  // CxRXD and CxTXD are the DMA controller's
}

void Ecan::write_window(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ecan& self = *static_cast<Ecan*>(owner);
    if (self.at(kCtrl1) & kCTRL1["WIN"]) return self.around_.sfr.store(address, value, mask);
    const int offset = address - self.setup_.base;
    std::uint16_t* const word = self.of_buffers(offset);
    if (!word) return;
    if (offset >= kTr01Con) return self.write_controls((offset - kTr01Con) / 2, value, mask);
    *word = static_cast<std::uint16_t>(*word & (value | ~mask));  // flags: a 0 clears
    self.given_back();
}

// ---- registers

void Ecan::write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ecan& self = *static_cast<Ecan*>(owner);
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kCTRL1["OPMODE"]));
    self.mode_written();
}

void Ecan::write_timing(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ecan& self = *static_cast<Ecan*>(owner);
    if (self.mode() == Mode::Configuration) self.around_.sfr.store(address, value, mask);
}

void Ecan::write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    static_cast<Ecan*>(owner)->interrupts_written(address, value, mask, kClearable);
}

/// FSA moves the FIFO's pointers to its start.
void Ecan::write_fifo(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Ecan& self = *static_cast<Ecan*>(owner);
    self.around_.sfr.store(address, value, mask);
    const unsigned start = kFCTRL["FSA"].of(self.reg(address));
    self.at(kFifo) = static_cast<std::uint16_t>(start << kByteBits | start);
}

void Ecan::write_nothing(void*, std::uint16_t, std::uint16_t, std::uint16_t) {}

void Ecan::write_controls(int pair, std::uint16_t value, std::uint16_t mask) {
    for (int half = 0; half < 2; ++half) {
        const int buffer = 2 * pair + half;
        const unsigned shift = half * kByteBits;
        const unsigned lane = mask >> shift & kWritable;
        const std::uint8_t before = control_of(buffer);
        set_control(buffer, static_cast<std::uint8_t>((before & ~lane) | (value >> shift & lane)));
        if (lane) control_written(buffer, before & kTxReq);
    }
}

// ---- transmission

std::uint8_t Ecan::control_of(int buffer) const {
    return static_cast<std::uint8_t>(buffers_.control[static_cast<std::size_t>(buffer / 2)] >>
                                     (buffer % 2 ? kByteBits : 0));
}

void Ecan::set_control(int buffer, std::uint8_t control) {
    std::uint16_t& pair = buffers_.control[static_cast<std::size_t>(buffer / 2)];
    pair = static_cast<std::uint16_t>(buffer % 2 ? (pair & 0x00FF) | control << kByteBits
                                                 : (pair & 0xFF00) | control);
}

bool Ecan::sends(int buffer) const {
    return buffer < kTransmitters && (control_of(buffer) & kTxEn);
}

CanFrame Ecan::frame_of(int buffer, Cycle now) {
    Message words{};
    dma_.block(setup_.transmit_irq, static_cast<std::uint16_t>(setup_.base + kTxD),
               static_cast<unsigned>(buffer) * sizeof(Message), words, now);
    around_.interrupts.raise(setup_.transmit_irq, now);
    CanFrame frame;
    frame.id = words[0] >> 2 & 0x7FFu;
    frame.remote = words[0] & 2;
    frame.extended = words[0] & 1;
    if (frame.extended) {
        frame.id = frame.id << kIdBits | (words[1] & 0xFFFu) << 6 | words[2] >> 10;
        frame.remote = words[2] & 0x200;
    }
    frame.length = static_cast<std::uint8_t>(std::min(words[2] & 0xFu, 8u));
    if (!frame.remote)
        for (std::size_t i = 0; i < frame.length; ++i)
            frame.data[i] = static_cast<std::uint8_t>(words[3 + i / 2] >> (i % 2 ? kByteBits : 0));
    return frame;
}

void Ecan::was_sent(int buffer, Cycle now) {
    buffers_.sent = static_cast<std::uint8_t>(buffer);
    set_flags(kTbIf, now);
}

// ---- interrupts

void Ecan::show_code() {
    enum : unsigned { kNone = 0x40, kError, kWakeUp, kOverflow, kAlmostFull };
    const unsigned pending = at(kIntf) & at(kInte);
    unsigned code = kNone;
    if (pending & kTbIf) code = buffers_.sent;
    if (pending & kRbIf) code = buffers_.received;
    if (pending & kFifoIf) code = kAlmostFull;
    if (pending & kRbOvIf) code = kOverflow;
    if (pending & can::kWakIf) code = kWakeUp;
    if (pending & can::kErrIf) code = kError;
    std::uint16_t& vector = at(kVec);
    vector = static_cast<std::uint16_t>((vector & kVEC["FILHIT"]) | code);
}

}  // namespace puckloop::dspic
