#include "emu/dspic/peripherals/can/can.h"

#include "emu/dspic/peripherals/can/can_registers.h"

#include <algorithm>

namespace puckloop::dspic {

using namespace can;

namespace {

constexpr int kLast = kEc;
constexpr std::uint16_t kClearable = 0xFF | kRx0Ovr | kRx1Ovr;

CanLine::Place place_of(const Can::Setup& setup) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup.base + offset); };
    return {.unit = setup.unit,
            .ctrl = at(kCtrl),
            .cfg1 = at(kCfg1),
            .cfg2 = at(kCfg2),
            .intf = at(kIntf),
            .inte = at(kInte),
            .ec = at(kEc),
            .irq = setup.irq,
            .port = setup.port,
            .rx = setup.rx,
            .tx = setup.tx,
            .clock_quarters = 1,  // FCAN is four times FCY, or FCY
            .clock_quarters_set = 4,
            .transmitters = 3};
}

}  // namespace

Can::Can(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
         Pins& pins)
    : CanLine(around, place_of(setup), clock, ports, pins), setup_(setup) {
    for (int offset = 0; offset <= kLast; offset += 2) {
        const auto address = static_cast<std::uint16_t>(setup_.base + offset);
        if (!around_.sfr.info(address)) continue;
        const bool transmits = offset >= kTx + 2 * kBufferStep && offset <= kTx + kBufferCon;
        const bool receives = offset >= kRx + kBufferStep && offset <= kRx + kBufferCon;
        WriteHook write = write_setup;  // filters, masks, timing
        if (transmits) write = write_transmit;
        if (receives) write = write_receive;
        if (offset == kCtrl) write = write_control;
        if (offset >= kIntf) write = write_interrupts;
        around_.sfr.hook(address, this, nullptr, write);
    }
}

// ---- transmission

std::uint16_t& Can::control_register(int buffer) const {
    return at(kTx + kBufferStep * buffer + kBufferCon);
}

std::uint8_t Can::control_of(int buffer) const {
    return static_cast<std::uint8_t>(control_register(buffer));
}

void Can::set_control(int buffer, std::uint8_t control) {
    control_register(buffer) = control;
}

void Can::was_sent(int buffer, Cycle now) {
    set_flags(static_cast<std::uint16_t>(kTx0If << buffer), now);
}

CanFrame Can::frame_of(int buffer, Cycle) {
    const int base = kTx + kBufferStep * buffer;
    const unsigned sid = at(base), eid = at(base + 2), dlc = at(base + 4);
    CanFrame frame;
    frame.extended = sid & kTXSID["TXIDE"];
    frame.id = kTXSID["SID10_6"].of(sid) << 6 | kTXSID["SID5_0"].of(sid);
    frame.remote = sid & kTXSID["SRR"];
    if (frame.extended) {
        frame.id = frame.id << 18 | kTXEID["EID17_14"].of(eid) << 14 | kTXEID["EID13_6"].of(eid) << 6 |
                   kTXDLC["EID5_0"].of(dlc);
        frame.remote = dlc & kTXDLC["TXRTR"];
    }
    frame.length = static_cast<std::uint8_t>(std::min(kTXDLC["DLC"].of(dlc), 8u));
    if (!frame.remote)
        for (int i = 0; i < frame.length; ++i)
            frame.data[static_cast<std::size_t>(i)] =
                static_cast<std::uint8_t>(at(base + kData + (i & ~1)) >> (i % 2 ? 8 : 0));
    return frame;
}

// ---- interrupts

// ICODE: the first in line of the enabled flags.
void Can::show_code() {
    constexpr std::uint16_t kOrder[] = {kWakIf,      kRx0If,      kRx0If << 1, kTx0If,
                                        kTx0If << 1, kTx0If << 2, kErrIf};
    constexpr unsigned kFirstCode = 7;
    const unsigned pending = at(kIntf) & at(kInte);
    unsigned code = 0;
    for (unsigned i = 0; i < std::size(kOrder) && code == 0; ++i)
        if (pending & kOrder[i]) code = kFirstCode - i;
    std::uint16_t& ctrl = at(kCtrl);
    ctrl = static_cast<std::uint16_t>((ctrl & ~kCTRL["ICODE"]) | code << 1);
}

// ---- registers

void Can::write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const auto writable = static_cast<std::uint16_t>(mask & ~(kCTRL["OPMODE"] | kCTRL["ICODE"]));
    self.around_.sfr.store(address, value, writable);
    self.mode_written();
}

void Can::write_transmit(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const int offset = address - self.setup_.base;
    const int buffer = (kTx + kBufferCon - offset) / -kBufferStep;
    const bool asked = self.control_of(buffer) & kTxReq;
    if ((offset & 0xE) != kBufferCon) {  // read only while it waits to be sent
        if (!asked) self.around_.sfr.store(address, value, mask);
        return;
    }
    self.around_.sfr.store(address, value,
                           static_cast<std::uint16_t>(mask & (kTXCON["TXREQ"] | kTXCON["TXPRI"])));
    self.control_written(buffer, asked);
}

// The program can only give a receive buffer back.
void Can::write_receive(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const int offset = address - self.setup_.base;
    std::uint16_t& con = self.around_.sfr.raw(address);
    if (offset == kRx + kBufferCon) self.around_.sfr.store(address, value, mask & kRX0CON["DBEN"]);
    if ((offset & 0xE) == kBufferCon && (mask & kRX0CON["RXFUL"]) && !(value & kRX0CON["RXFUL"]))
        assign(con, kRX0CON["RXFUL"], false);
}

void Can::write_setup(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    if (self.mode() == Mode::Configuration) self.around_.sfr.store(address, value, mask);
}

void Can::write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    static_cast<Can*>(owner)->interrupts_written(address, value, mask, kClearable);
}

}  // namespace puckloop::dspic
