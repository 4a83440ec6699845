#include "emu/avr/chip/chip_faults.h"

#include "emu/avr/core/core.h"
#include "emu/avr/devices/device.h"
#include "emu/avr/peripherals/eeprom.h"
#include "emu/image/image_hash.h"

#include <algorithm>
#include <array>
#include <utility>

namespace puckloop::avr {

namespace {

using chip::MemoryPlace;
using chip::MemorySpace;

constexpr std::uint32_t kByte = 0xFF, kProgramWord = 0xFFFF;
constexpr std::array<std::string_view, 32> kR{"R0",  "R1",  "R2",  "R3",  "R4",  "R5",  "R6",  "R7",
                                              "R8",  "R9",  "R10", "R11", "R12", "R13", "R14", "R15",
                                              "R16", "R17", "R18", "R19", "R20", "R21", "R22", "R23",
                                              "R24", "R25", "R26", "R27", "R28", "R29", "R30", "R31"};
constexpr std::uint32_t kWorking = 32;

/// Where a source is enabled.
struct Enable {
    std::string_view source, mask;  ///< data-sheet names; the mask register's
    int bit;
};
constexpr std::array<Enable, 34> kEnables{{
    {"INT0", "EIMSK", 0},          {"INT1", "EIMSK", 1},
    {"INT2", "EIMSK", 2},          {"PCINT0", "PCICR", 0},
    {"PCINT1", "PCICR", 1},        {"PCINT2", "PCICR", 2},
    {"PCINT3", "PCICR", 3},        {"WDT", "WDTCSR", 6},
    {"TIMER2_COMPA", "TIMSK2", 1}, {"TIMER2_COMPB", "TIMSK2", 2},
    {"TIMER2_OVF", "TIMSK2", 0},   {"TIMER1_CAPT", "TIMSK1", 5},
    {"TIMER1_COMPA", "TIMSK1", 1}, {"TIMER1_COMPB", "TIMSK1", 2},
    {"TIMER1_OVF", "TIMSK1", 0},   {"TIMER0_COMPA", "TIMSK0", 1},
    {"TIMER0_COMPB", "TIMSK0", 2}, {"TIMER0_OVF", "TIMSK0", 0},
    {"SPI_STC", "SPCR", 7},        {"USART0_RX", "UCSR0B", 7},
    {"USART0_UDRE", "UCSR0B", 5},  {"USART0_TX", "UCSR0B", 6},
    {"ANALOG_COMP", "ACSR", 3},    {"ADC", "ADCSRA", 3},
    {"EE_READY", "EECR", 3},       {"TWI", "TWCR", 0},
    {"SPM_READY", "SPMCSR", 7},    {"USART1_RX", "UCSR1B", 7},
    {"USART1_UDRE", "UCSR1B", 5},  {"USART1_TX", "UCSR1B", 6},
    {"TIMER3_CAPT", "TIMSK3", 5},  {"TIMER3_COMPA", "TIMSK3", 1},
    {"TIMER3_COMPB", "TIMSK3", 2}, {"TIMER3_OVF", "TIMSK3", 0},
}};

/// A write to these does something whatever is written: only what is stored there flips.
bool acts_on_write(std::string_view name) {
    constexpr std::array<std::string_view, 4> kNames{"UDR0", "UDR1", "SPDR", "TWDR"};
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

}  // namespace

void ChipFaults::set_stops(std::span<const std::uint32_t> addresses) {
    chip_.set_stops({addresses.begin(), addresses.end()});
}

bool ChipFaults::knows(chip::FaultReset cause) const {
    return cause <= chip::FaultReset::Watchdog;
}

void ChipFaults::reset(chip::FaultReset cause) {
    constexpr std::array kCauses{ResetCause::PowerOn, ResetCause::BrownOut, ResetCause::External,
                                 ResetCause::Watchdog};
    chip_.inside().core.reset(kCauses.at(static_cast<std::size_t>(cause)));
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
        return in.device.ram_bytes;
    case MemorySpace::Flash:
        return in.device.flash_words;
    case MemorySpace::Eeprom:
        return in.device.eeprom_bytes;
    case MemorySpace::Register:
        break;
    }
    return static_cast<std::uint32_t>(in.device.registers.size());
}

MemoryPlace ChipFaults::cell(MemorySpace space, std::uint32_t i) const {
    const Chip::Inside in = chip_.inside();
    switch (space) {
    case MemorySpace::Ram:
        return {space, in.device.ram_start + i};
    case MemorySpace::Flash:
        return {space, 2 * i};
    case MemorySpace::Eeprom:
        return {space, i};
    case MemorySpace::Register:
        break;
    }
    return {space, in.device.registers[i].address};
}

std::optional<MemoryPlace> ChipFaults::find_register(std::string_view name) const {
    if (const auto r = std::find(kR.begin(), kR.end(), name); r != kR.end())
        return MemoryPlace{MemorySpace::Register, static_cast<std::uint32_t>(r - kR.begin())};
    const RegisterInfo* info = chip_.inside().io.find(name);
    if (!info) return std::nullopt;
    return MemoryPlace{MemorySpace::Register, info->address};
}

std::uint32_t ChipFaults::bits(const MemoryPlace& place) const {
    const Chip::Inside in = chip_.inside();
    switch (place.space) {
    case MemorySpace::Ram:
        return place.address >= in.device.ram_start && place.address < in.device.ram_end() ? kByte : 0;
    case MemorySpace::Flash:
        return place.address % 2 == 0 && place.address < in.device.flash_bytes() ? kProgramWord : 0;
    case MemorySpace::Eeprom:
        return place.address < in.device.eeprom_bytes ? kByte : 0;
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWorking) return kByte;
    if (place.address >= in.device.ram_start) return 0;
    const RegisterInfo* info = in.io.info(static_cast<std::uint16_t>(place.address));
    return info ? info->implemented : 0;
}

std::uint32_t ChipFaults::read(const MemoryPlace& place) const {
    Chip::Inside in = chip_.inside();
    const auto address = static_cast<std::uint16_t>(place.address);
    switch (place.space) {
    case MemorySpace::Ram:
        return chip_.peek_data(address);
    case MemorySpace::Flash:
        return in.core.program(place.address / 2);
    case MemorySpace::Eeprom:
        return in.eeprom.bytes()[place.address];
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWorking) return in.core.read_data(address);
    const std::string_view register_name = name(place);
    if (register_name == "SREG") return in.core.state().sreg;
    if (register_name == "SPL") return in.core.state().sp & kByte;
    if (register_name == "SPH") return in.core.state().sp >> 8;
    return chip_.look(address);
}

void ChipFaults::flip(const MemoryPlace& place, std::uint32_t mask) {
    Chip::Inside in = chip_.inside();
    const auto address = static_cast<std::uint16_t>(place.address);
    const auto flipped = static_cast<std::uint8_t>(read(place) ^ mask);
    switch (place.space) {
    case MemorySpace::Ram:
        in.core.ram()[address - in.device.ram_start] = flipped;
        return;
    case MemorySpace::Flash:
        in.core.set_program(place.address / 2, static_cast<std::uint16_t>(read(place) ^ mask));
        return;
    case MemorySpace::Eeprom:
        in.eeprom.poke(place.address, flipped);
        return;
    case MemorySpace::Register:
        break;
    }
    if (place.address < kWorking) return in.core.write_data(address, flipped);
    // As a write of these bits by the program, so that the module follows; a bit that the program cannot
    // write flips where it is stored.
    if (!acts_on_write(name(place))) in.io.write(address, flipped, static_cast<std::uint8_t>(mask));
    if (const std::uint32_t left = (read(place) ^ flipped) & mask; left)
        in.io.raw(address) = static_cast<std::uint8_t>(in.io.raw(address) ^ left);
}

image::AvrImage ChipFaults::load(const std::string& file, const std::string& sha256) const {
    image::AvrImage image = image::load_avr_image(file, chip_.inside().device.image_part());
    image::check_hash(file, image.sha256, sha256);
    return image;
}

std::string_view ChipFaults::name(const MemoryPlace& place) const {
    if (place.space != MemorySpace::Register) return {};
    if (place.address < kWorking) return kR[place.address];
    const RegisterInfo* info = chip_.inside().io.info(static_cast<std::uint16_t>(place.address));
    return info ? info->name : std::string_view{};
}

std::optional<int> ChipFaults::vector(std::string_view source) const {
    const std::span<const VectorInfo> vectors = chip_.inside().device.vectors;
    const auto found = std::find_if(vectors.begin(), vectors.end(), [&](const VectorInfo& info) {
        return info.name == source && info.number != 0;
    });
    if (found == vectors.end()) return std::nullopt;
    return found->number;
}

bool ChipFaults::interrupt(int vector) {
    Chip::Inside in = chip_.inside();
    const std::string_view source = in.device.vector_name(vector);
    const auto* const enable = std::find_if(kEnables.begin(), kEnables.end(),
                                            [&](const Enable& one) { return one.source == source; });
    if (enable == kEnables.end()) return false;
    const RegisterInfo* const mask = in.io.find(enable->mask);
    if (mask == nullptr || !(in.io.raw(mask->address) & bit(enable->bit))) return false;
    in.interrupts.force(vector);
    return true;
}

void ChipFaults::watch_interrupts(std::span<const int> vectors, chip::InterruptTime when) {
    when_ = std::move(when);
    std::uint64_t mask = 0;
    for (const int vector : vectors)
        mask |= std::uint64_t{1} << vector;
    chip_.inside().interrupts.set_gate(this, &passes, mask);
}

bool ChipFaults::passes(void* owner, int vector) {
    const auto& self = *static_cast<const ChipFaults*>(owner);
    Chip::Inside in = self.chip_.inside();
    const cosim::Time time = in.clock.time_of(in.core.now());
    const cosim::Time when = self.when_(vector, time);
    if (when <= time) return true;
    const bool lost = when == cosim::kNever;
    in.held.hold(vector, lost, lost ? in.core.now() : in.clock.first_cycle_at(when));
    return false;
}

}  // namespace puckloop::avr
