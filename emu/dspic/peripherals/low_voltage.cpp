#include "emu/dspic/peripherals/low_voltage.h"

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kRCON{"RCON"};
constexpr double kBandGapSeconds = 40e-6;
/// Volts by LVDL; 0: never.
constexpr double kTrip[16] = {0,    0,     0,    0,     2.575, 2.78,  2.885, 3.09,
                              3.40, 3.605, 3.71, 3.915, 4.12,  4.325, 4.635, 0};

}  // namespace

LowVoltage::LowVoltage(const Surroundings& around, std::uint8_t irq, Pins& pins)
    : around_(around), irq_(irq), pins_(pins), slot_(around.events.add(this, due)) {}

std::uint16_t& LowVoltage::rcon() const {
    return around_.sfr.raw(sfr::RCON);
}

void LowVoltage::reset(bool brown_out) {
    brown_out_ = brown_out;
    below_ = false;
    around_.events.cancel(slot_);
}

void LowVoltage::changed(double cycle_hertz) {
    std::uint16_t& value = rcon();
    if (brown_out_) {
        value |= kRCON["BGST"];
    } else if (!(value & kRCON["LVDEN"])) {
        assign(value, kRCON["BGST"], false);
        around_.events.cancel(slot_);
    } else if (!(value & kRCON["BGST"]) && around_.events.due(slot_) == kNoCycle) {
        around_.events.schedule(slot_, around_.now + 1 + static_cast<Cycle>(kBandGapSeconds * cycle_hertz));
    }
    look(around_.now + 1);
}

void LowVoltage::due(void* owner, Cycle due) {
    LowVoltage& self = *static_cast<LowVoltage*>(owner);
    self.rcon() |= kRCON["BGST"];
    self.look(due);
}

void LowVoltage::look(Cycle at) {
    const unsigned value = rcon();
    const bool on = (value & kRCON["LVDEN"]) && (value & kRCON["BGST"]);
    const bool below = on && pins_.supply() < kTrip[kRCON["LVDL"].of(value)];
    if (below && !below_) around_.interrupts.raise(irq_, at);
    below_ = below;
}

}  // namespace puckloop::dspic
