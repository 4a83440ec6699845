#include "emu/dspic/chip/module_disable.h"

#include "emu/dspic/peripherals/adc12.h"

namespace puckloop::dspic {

namespace {

// Bits of PMD1, and of PMD3 for a second or a later one; PMD2 has input captures above output compares.
constexpr int kAdc = 0, kCan = 1, kSpi = 3, kUart = 5, kI2c = 7, kDci = 8, kTimer = 11;
constexpr int kSecondAdc = 0, kSecondI2c = 1, kTimer6 = 12;
constexpr int kInputCapture = 8;
constexpr int kDciWords = 16;

std::vector<std::uint16_t> range(std::uint16_t first, int words) {
    std::vector<std::uint16_t> addresses;
    for (int i = 0; i < words; ++i)
        addresses.push_back(static_cast<std::uint16_t>(first + 2 * i));
    return addresses;
}

}  // namespace

ModuleDisable::ModuleDisable(SfrSpace& sfr, const Layout& layout,
                             const std::array<std::uint16_t, 3>& registers)
    : sfr_(sfr), registers_(registers) {
    const auto [pmd1, pmd2, pmd3] = registers;
    for (const std::uint16_t address : registers)
        if (address) sfr_.hook(address, this, nullptr, write);
    for (const TimerPlace& place : layout.timers) {
        const bool later = place.number > 5;
        add(later ? pmd3 : pmd1, later ? kTimer6 + place.number - 6 : kTimer + place.number - 1,
            place.setup.con, {place.setup.tmr, place.setup.pr, place.setup.con});
    }
    for (const Uart::Setup& uart : layout.uarts)
        add(pmd1, kUart + uart.unit - 1, uart.mode, range(uart.mode, 5));
    for (const Spi::Setup& spi : layout.spis)
        add(pmd1, kSpi + spi.unit - 1, spi.stat, range(spi.stat, (spi.buf - spi.stat) / 2 + 1));
    for (const Can::Setup& can : layout.cans)
        add(pmd1, kCan + can.unit - 1, Can::control(can), range(can.base, Can::kWords));
    for (const Ecan::Setup& ecan : layout.ecans)
        add(pmd1, kCan + ecan.unit - 1, Ecan::control(ecan), range(ecan.base, Ecan::kWords));
    for (const I2cMaster::Setup& i2c : layout.i2cs)
        add(i2c.unit == 1 ? pmd1 : pmd3, i2c.unit == 1 ? kI2c : kSecondI2c,
            static_cast<std::uint16_t>(i2c.rcv + 6), range(i2c.rcv, i2c.has_mask ? 7 : 6));
    if (layout.dci.con1) add(pmd1, kDci, layout.dci.con1, range(layout.dci.con1, kDciWords));
    if (layout.adc12) add(pmd1, kAdc, Adc12::kControl, range(Adc12::kFirst, Adc12::kWords));
    for (std::size_t i = 0; i < layout.adcs.size(); ++i)
        add(i == 0 ? pmd1 : pmd3, i == 0 ? kAdc : kSecondAdc, layout.adcs[i].con1,
            range(layout.adcs[i].con1, 3));
    int bit = 0;
    for (const OutputCompare::Unit& unit : layout.output_compare.units)
        add(pmd2, bit++, static_cast<std::uint16_t>(unit.rs + 4), range(unit.rs, 3));
    bit = kInputCapture;
    for (const InputCapture::Unit& unit : layout.input_captures)
        add(pmd2, bit++, static_cast<std::uint16_t>(unit.buf + 2), range(unit.buf, 2));
}

void ModuleDisable::add(std::uint16_t pmd, int bit, std::uint16_t control,
                        std::vector<std::uint16_t> registers) {
    std::erase_if(registers, [&](std::uint16_t address) { return !sfr_.info(address); });
    modules_.push_back({pmd, static_cast<std::uint16_t>(1u << bit), control, std::move(registers), false});
}

void ModuleDisable::switch_off(Module& module) {
    constexpr std::uint16_t kAll = 0xFFFF;
    sfr_.write(module.control, sfr_.info(module.control)->reset, kAll);
    for (const std::uint16_t address : module.registers)
        sfr_.write(address, sfr_.info(address)->reset, kAll);
    for (const std::uint16_t address : module.registers) {
        sfr_.raw(address) = sfr_.info(address)->reset;
        sfr_.set_off(address, true);
    }
    module.off = true;
}

void ModuleDisable::switch_on(Module& module) {
    for (const std::uint16_t address : module.registers) {
        sfr_.set_off(address, false);
        sfr_.raw(address) = sfr_.info(address)->reset;
    }
    module.off = false;
}

void ModuleDisable::write(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    ModuleDisable& self = *static_cast<ModuleDisable*>(owner);
    self.sfr_.store(address, value, mask);
    for (Module& module : self.modules_) {
        if (module.pmd != address) continue;
        const bool off = self.sfr_.raw(address) & module.mask;
        if (off && !module.off) self.switch_off(module);
        if (!off && module.off) self.switch_on(module);
    }
}

void ModuleDisable::restore() {
    for (Module& module : modules_) {
        const bool off = module.pmd && (sfr_.raw(module.pmd) & module.mask);
        if (off == module.off) continue;
        for (const std::uint16_t address : module.registers)
            sfr_.set_off(address, off);
        module.off = off;
    }
}

}  // namespace puckloop::dspic
