#include "emu/dspic/chip/chip_faults.h"

#include "emu/dspic/core/core.h"
#include "emu/dspic/machine/memory_map.h"
#include "emu/image/device.h"
#include "emu/image/image_hash.h"

#include <algorithm>
#include <array>
#include <utility>

namespace puckloop::dspic {

namespace {

using chip::MemoryPlace;
using chip::MemorySpace;

constexpr std::uint32_t kWord = 0xFFFF, kProgramWord = 0xFFFFFF;
constexpr std::array<std::string_view, 16> kW{"W0", "W1", "W2",  "W3",  "W4",  "W5",  "W6",  "W7",
                                              "W8", "W9", "W10", "W11", "W12", "W13", "W14", "W15"};

/// A write to these does something whatever is written: only what is stored there flips.
bool acts_on_write(std::string_view name) {
    for (const std::string_view pattern : {"*TXREG", "*TRN", "SPI?BUF", "NVMKEY", "*RCREG", "*RXREG"})
        if (name_fits(pattern, name)) return true;
    return false;
}

ResetCause cause_of(chip::FaultReset cause) {
    switch (cause) {
    case chip::FaultReset::PowerOn:
        return ResetCause::PowerOn;
    case chip::FaultReset::BrownOut:
        return ResetCause::BrownOut;
    case chip::FaultReset::External:
        return ResetCause::Mclr;
    case chip::FaultReset::Watchdog:
        return ResetCause::Watchdog;
    case chip::FaultReset::Software:
        return ResetCause::Software;
    case chip::FaultReset::Trap:
        return ResetCause::TrapConflict;
    case chip::FaultReset::IllegalOpcode:
        return ResetCause::IllegalOpcode;
    }
    return ResetCause::Mclr;
}

}  // namespace

void ChipFaults::set_stops(std::span<const std::uint32_t> addresses) {
    chip_.set_stops({addresses.begin(), addresses.end()});
}

void ChipFaults::reset(chip::FaultReset cause) {
    chip_.inside().core.reset(cause_of(cause));
}

void ChipFaults::hang(cosim::Time until) {
    Chip::Inside in = chip_.inside();
    in.core.stall_until(until == cosim::kNever ? kNoCycle : in.clock.first_cycle_at(until));
}

void ChipFaults::set_ppm(double ppm) {
    Chip::Inside in = chip_.inside();
    if (ppm == in.clock.ppm()) return;
    in.clock.change_ppm(std::max(in.core.cycle(), in.clock.first_cycle_at(chip_.now())), ppm);
}

std::uint32_t ChipFaults::cells(MemorySpace space) const {
    const Chip::Inside in = chip_.inside();
    switch (space) {
    case MemorySpace::Ram:
        return (in.device.ram_end - in.device.ram_start) / 2u;
    case MemorySpace::Flash:
        return in.device.flash_end / 2;
    case MemorySpace::Eeprom:
        return in.device.eeprom_words;
    case MemorySpace::Register:
        break;
    }
    return static_cast<std::uint32_t>(
        std::count_if(in.device.registers.begin(), in.device.registers.end(),
                      [&](const RegisterInfo& info) { return in.sfr.modelled(info.address); }));
}

MemoryPlace ChipFaults::cell(MemorySpace space, std::uint32_t i) const {
    const Chip::Inside in = chip_.inside();
    switch (space) {
    case MemorySpace::Ram:
        return {space, in.device.ram_start + 2 * i};
    case MemorySpace::Flash:
        return {space, 2 * i};
    case MemorySpace::Eeprom:
        return {space, in.device.eeprom_start + 2 * i};
    case MemorySpace::Register:
        break;
    }
    for (const RegisterInfo& info : in.device.registers)
        if (in.sfr.modelled(info.address) && i-- == 0) return {space, info.address};
    return {space, kRamStart};
}

std::optional<MemoryPlace> ChipFaults::find_register(std::string_view name) const {
    const Chip::Inside in = chip_.inside();
    if (const auto w = std::find(kW.begin(), kW.end(), name); w != kW.end())
        return MemoryPlace{MemorySpace::Register, static_cast<std::uint32_t>(2 * (w - kW.begin()))};
    const RegisterInfo* info = in.sfr.find(name);
    if (!info || !in.sfr.modelled(info->address)) return std::nullopt;
    return MemoryPlace{MemorySpace::Register, info->address};
}

std::uint32_t ChipFaults::bits(const MemoryPlace& place) const {
    const Chip::Inside in = chip_.inside();
    if (place.address % 2) return 0;
    const auto within = [&](std::uint32_t first, std::uint32_t end) {
        return place.address >= first && place.address < end;
    };
    switch (place.space) {
    case MemorySpace::Ram:
        return within(in.device.ram_start, in.device.ram_end) ? kWord : 0;
    case MemorySpace::Flash:
        return within(0, in.device.flash_end) ? kProgramWord : 0;
    case MemorySpace::Eeprom:
        return within(in.device.eeprom_start, in.device.eeprom_start + 2 * in.device.eeprom_words) ? kWord
                                                                                                   : 0;
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWEnd) return place.address == kWEnd - 2 ? kWord - 1 : kWord;
    if (place.address >= kRamStart) return 0;
    const auto address = static_cast<std::uint16_t>(place.address);
    const RegisterInfo* info = in.sfr.info(address);
    return info && in.sfr.modelled(address) ? info->implemented : 0;
}

std::uint32_t ChipFaults::read(const MemoryPlace& place) const {
    const Chip::Inside in = chip_.inside();
    const auto address = static_cast<std::uint16_t>(place.address);
    switch (place.space) {
    case MemorySpace::Ram:
        return chip_.peek_data(address);
    case MemorySpace::Flash:
    case MemorySpace::Eeprom:
        return in.core.program(place.address);
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWEnd) return in.core.w(address / 2);
    if (in.sfr.quiet(address)) return in.sfr.quiet_read(address);
    return chip_.peek(in.sfr.info(address)->name);
}

void ChipFaults::flip(const MemoryPlace& place, std::uint32_t mask) {
    Chip::Inside in = chip_.inside();
    const auto address = static_cast<std::uint16_t>(place.address);
    switch (place.space) {
    case MemorySpace::Ram:
        in.core.ram()[(address - in.device.ram_start) / 2u] ^= static_cast<std::uint16_t>(mask);
        return;
    case MemorySpace::Flash:
    case MemorySpace::Eeprom:
        in.core.poke_program(place.address, in.core.program(place.address) ^ mask);
        return;
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWEnd)
        in.core.set_w(address / 2, static_cast<std::uint16_t>(in.core.w(address / 2) ^ mask));
    else
        flip_register(address, static_cast<std::uint16_t>(mask));
}

/// As a write by the program, so that the module follows; a bit that the program cannot write flips where it
/// is stored.
void ChipFaults::flip_register(std::uint16_t address, std::uint16_t mask) {
    Chip::Inside in = chip_.inside();
    const std::uint16_t before = static_cast<std::uint16_t>(read({MemorySpace::Register, address}));
    const auto wanted = static_cast<std::uint16_t>(before ^ mask);
    if (!acts_on_write(in.sfr.info(address)->name)) {
        const auto low = static_cast<std::uint16_t>(mask & 0x00FF ? 0x00FF : 0);
        const auto high = static_cast<std::uint16_t>(mask & 0xFF00 ? 0xFF00 : 0);
        in.sfr.write(address, wanted, low | high);
    }
    const auto after = static_cast<std::uint16_t>(read({MemorySpace::Register, address}));
    if (const auto left = static_cast<std::uint16_t>((after ^ wanted) & mask); left)
        in.sfr.raw(address) = static_cast<std::uint16_t>(in.sfr.raw(address) ^ left);
}

image::Image ChipFaults::load(const std::string& file, const std::string& sha256) const {
    image::Image image = image::load_image(file);
    image::check_fits(image, image::find_device(chip_.inside().device.name));
    image::check_hash(file, image.sha256, sha256);
    return image;
}

std::string_view ChipFaults::name(const MemoryPlace& place) const {
    if (place.space != MemorySpace::Register) return {};
    if (place.address < kWEnd) return kW[place.address / 2];
    const RegisterInfo* info = chip_.inside().sfr.info(static_cast<std::uint16_t>(place.address));
    return info ? info->name : std::string_view{};
}

std::optional<int> ChipFaults::vector(std::string_view source) const {
    return chip_.inside().device.irq(source);
}

bool ChipFaults::interrupt(int vector) {
    Chip::Inside in = chip_.inside();
    in.interrupts.request(vector, in.core.cycle());
    in.interrupts.set_flag(vector, in.core.cycle());
    return true;
}

void ChipFaults::watch_interrupts(std::span<const int> vectors, chip::InterruptTime when) {
    when_ = std::move(when);
    std::array<std::uint64_t, 2> irqs{};
    for (const int irq : vectors)
        irqs[static_cast<std::size_t>(irq) / 64] |= std::uint64_t{1} << (irq % 64);
    chip_.inside().interrupts.set_gate(this, &passes, irqs);
}

bool ChipFaults::passes(void* owner, int irq, Cycle now) {
    const auto& self = *static_cast<const ChipFaults*>(owner);
    Chip::Inside in = self.chip_.inside();
    const cosim::Time time = in.clock.time_of(now);
    const cosim::Time when = self.when_(irq, time);
    if (when <= time) return true;
    if (when != cosim::kNever) in.held.hold(irq, false, in.clock.first_cycle_at(when));
    return false;
}

}  // namespace puckloop::dspic
