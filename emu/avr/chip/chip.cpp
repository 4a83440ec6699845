#include "emu/avr/chip/chip.h"

#include "emu/avr/chip/chip_parts.h"

#include <algorithm>
#include <stdexcept>

namespace puckloop::avr {

Chip::Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options)
    : parts_(std::make_unique<Parts>(device, pins, options)) {}
Chip::~Chip() = default;

const image::CodePlaces& Chip::places() const {
    return parts_->places;
}

void Chip::name_places(const image::AvrImage& image) {
    parts_->places = image::CodePlaces(image.symbols, image.file, image.sha256);
}

void Chip::program(const image::AvrImage& image) {
    constexpr std::uint8_t kErasedByte = 0xFF;
    Parts& p = *parts_;
    name_places(image);
    std::vector<std::uint16_t> words(p.device.flash_words, kErasedWord);
    const std::uint32_t boot_start = p.device.flash_words - p.fuses.boot_words();
    bool loads_boot = false;
    for (const image::ByteSegment& segment : image.flash)
        for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
            const auto address = static_cast<std::uint32_t>(segment.address + i);
            std::uint16_t& word = words[address / 2];
            const std::uint16_t byte = segment.bytes[i];
            word = static_cast<std::uint16_t>(address & 1 ? (word & 0x00FF) | byte << 8
                                                          : (word & 0xFF00) | byte);
            loads_boot |= address / 2 >= boot_start;
        }
    const std::uint32_t end = p.fuses.boot_reset() && !loads_boot ? boot_start : p.device.flash_words;
    for (std::uint32_t word = 0; word < end; ++word)
        p.core.set_program(word, words[word]);
    if (!p.fuses.keep_eeprom())
        for (std::size_t cell = 0; cell < p.eeprom.bytes().size(); ++cell)
            p.eeprom.poke(cell, kErasedByte);
    for (const image::ByteSegment& segment : image.eeprom)
        for (std::size_t i = 0; i < segment.bytes.size(); ++i)
            p.eeprom.poke(segment.address + i, segment.bytes[i]);
    p.fuses.lock = image.lock_bits.value_or(kErasedByte);
}

void Chip::load(const image::AvrImage& image) {
    name_places(image);
    for (const image::ByteSegment& segment : image.flash)
        for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
            const auto address = static_cast<std::uint32_t>(segment.address + i);
            const std::uint16_t old = parts_->core.program(address / 2);
            const std::uint16_t byte = segment.bytes[i];
            parts_->core.set_program(
                address / 2,
                static_cast<std::uint16_t>(address & 1 ? (old & 0x00FF) | byte << 8 : (old & 0xFF00) | byte));
        }
    for (const image::ByteSegment& segment : image.eeprom)
        std::copy(segment.bytes.begin(), segment.bytes.end(),
                  parts_->eeprom.bytes().begin() + static_cast<std::ptrdiff_t>(segment.address));
    Fuses& fuses = parts_->fuses;
    std::uint8_t* const places[] = {&fuses.low, &fuses.high, &fuses.extended};
    for (std::size_t i = 0; i < std::min<std::size_t>(image.fuses.size(), std::size(places)); ++i)
        *places[i] = image.fuses[i];
    if (image.lock_bits) fuses.lock = *image.lock_bits;
}

image::AvrImage Chip::memory() const {
    image::AvrImage image;
    image::ByteSegment flash;
    for (std::uint32_t word = 0; word < parts_->device.flash_words; ++word) {
        const std::uint16_t value = parts_->core.program(word);
        flash.bytes.push_back(static_cast<std::uint8_t>(value));
        flash.bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    }
    image.flash.push_back(std::move(flash));
    image.eeprom.push_back({0, parts_->eeprom.bytes()});
    const Fuses& fuses = parts_->fuses;
    image.fuses = {fuses.low, fuses.high, fuses.extended};
    image.lock_bits = fuses.lock;
    return image;
}

std::vector<std::uint8_t>& Chip::eeprom() {
    return parts_->eeprom.bytes();
}
const Fuses& Chip::fuses() const {
    return parts_->fuses;
}

void Chip::set_fuses(const Fuses& fuses) {
    parts_->fuses = fuses;
}

void Chip::power_on() {
    Parts& p = *parts_;
    constexpr std::uint8_t kClockOut = bit(6);  // CKOUT, programmed = 0
    if (!(p.fuses.low & kClockOut))
        keep(p.report.warnings, {"fuse CKOUT is programmed: the clock at PB1 has no model", 0});
    parts_->core.reset(ResetCause::PowerOn);
}
void Chip::external_reset() {
    parts_->at_present();
    parts_->core.request_reset(ResetCause::External);
}

void Chip::reset_now() {
    parts_->at_present();
    parts_->core.reset(ResetCause::External);
}

void Chip::set_supply(double volts) {
    parts_->at_present();
    parts_->adc.set_avcc(volts);
    parts_->supply.set(volts, parts_->core.now());
}

double Chip::supply() const {
    return parts_->supply.volts();
}

void Chip::run_until(cosim::Time until) {
    Parts& p = *parts_;
    p.stopped = false;
    while (true) {  // a change of the clock's rate ends a run early: its end is another cycle now
        const Cycle end = p.clock.first_cycle_at(until);
        const Core::Outcome outcome = p.core.run(end);
        if (outcome == Core::Outcome::Stopped) {
            p.stopped = true;
            p.now = std::min(until, p.clock.time_of(p.core.cycle()));
            return;
        }
        if (p.core.cycle() >= p.clock.first_cycle_at(until)) break;
    }
    p.now = until;
}

void Chip::stop_at(std::uint32_t pc) {
    parts_->stops.push_back(static_cast<std::uint16_t>(pc / 2));
    parts_->core.set_stops(parts_->stops);
}
std::optional<std::uint32_t> Chip::stopped_at() const {
    if (!parts_->stopped) return std::nullopt;
    return pc();
}

void Chip::uart_receive(int unit, const cosim::UartFrame& frame) {
    parts_->at_present();
    parts_->usart(unit).receive(frame, parts_->core.now());
}
void Chip::twi_answer(const cosim::I2cPhase& phase) {
    parts_->at_present();
    parts_->twi.answer(phase);
}
void Chip::twi_answer_at(const cosim::I2cPhase& phase, cosim::Time time) {
    parts_->twi.answer_at(phase, parts_->clock.first_cycle_at(time));
}
void Chip::twi_slave_phase(const cosim::I2cPhase& phase) {
    parts_->at_present();
    parts_->twi.slave_phase(phase);
}
void Chip::pins_changed(PortLetter port) {
    parts_->at_present();
    parts_->ports.pins_changed(port);
    parts_->comparator.update();
}
cosim::Time Chip::earliest_twi_slave_answer() const {
    const Parts& p = *parts_;
    const Cycle cycle = p.twi.earliest_slave_answer(std::max(p.core.cycle(), p.clock.first_cycle_at(p.now)));
    return cycle == kNoCycle ? cosim::kNever : p.clock.time_of(cycle);
}

std::optional<cosim::Time> Chip::uart_begun(int unit) const {
    const auto frame = parts_->usart(unit).begun();
    if (!frame) return std::nullopt;
    return frame->start;
}
const chip::UartCounters& Chip::uart_counters(int unit) const {
    return parts_->usart(unit).counters();
}
bool Chip::uart_listens(int unit) const {
    return parts_->usart(unit).receiving();
}
bool Chip::pin_level(Pin pin) const {
    return parts_->ports.level(pin);
}

const cosim::ClockDomain& Chip::clock() const {
    return parts_->clock;
}
cosim::Time Chip::now() const {
    return parts_->now;
}
Cycle Chip::cycle() const {
    return parts_->core.cycle();
}
std::uint32_t Chip::pc() const {
    return 2u * parts_->core.pc();
}
bool Chip::sleeping() const {
    return parts_->core.sleeping();
}
cosim::Time Chip::wakes() const {
    const Parts& p = *parts_;
    if (!p.core.rests()) return p.now;
    const Cycle next = p.events.next();
    return next == kNoCycle ? cosim::kNever : std::max(p.now, p.clock.time_of(next));
}
std::uint8_t Chip::peek(std::string_view register_name) const {
    const RegisterInfo* info = parts_->io.find(register_name);
    if (!info) throw std::out_of_range("no register " + std::string(register_name));
    return parts_->io.raw(info->address);
}
std::uint8_t Chip::look(std::uint16_t address) const {
    parts_->at_present();
    return parts_->io.quiet_read(address);
}
std::uint8_t Chip::peek_data(std::uint16_t address) const {
    const DeviceInfo& device = parts_->device;
    if (address < device.ram_start || address >= device.ram_end()) throw std::out_of_range("no RAM there");
    return parts_->core.ram()[address - device.ram_start];
}

Chip::Inside Chip::inside() {
    Parts& p = *parts_;
    p.at_present();
    return {p.device, p.core, p.io, p.interrupts, p.clock, p.eeprom, p.held};
}

void Chip::set_stops(const std::vector<std::uint32_t>& addresses) {
    parts_->stops.clear();
    for (const std::uint32_t pc : addresses)
        parts_->stops.push_back(static_cast<std::uint16_t>(pc / 2));
    parts_->core.set_stops(parts_->stops);
}

void Chip::set_skipping(bool on) {
    parts_->core.set_skip_idle(on);
}

void Chip::set_translating(bool on) {
    parts_->core.set_translate(on);
}

}  // namespace puckloop::avr
