#include "emu/dspic/chip/chip.h"

#include "emu/dspic/chip/chip_parts.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <stdexcept>

namespace puckloop::dspic {

using cosim::Time;

namespace {
constexpr int kUartLookaheadBits = 9;

std::vector<ProgramWord> words_of(const image::Image& image) {
    std::vector<ProgramWord> words;
    for (const auto& [address, word] : image.all_words())
        words.push_back({address, word});
    return words;
}
}  // namespace

void Chip::Parts::arrive(Time time) {
    now = std::max(now, time);
    const Cycle reached = std::min(message_cycle(), core.cycle());
    if (adc12 && reached > 0) adc12->catch_up(reached - 1);
}

Chip::Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options)
    : parts_(std::make_unique<Parts>(device, pins, options)) {}

Chip::~Chip() = default;

void Chip::load(const image::Image& image) {
    image::check_fits(image, image::find_device(parts_->device.name));
    name_places(image);
    parts_->core.load(words_of(image));
}

void Chip::program(const image::Image& image) {
    name_places(image);
    parts_->core.reprogram(words_of(image));
}

void Chip::name_places(const image::Image& image) {
    parts_->places = image::CodePlaces(image.symbols, image.file, image.sha256);
}

void Chip::load_word(std::uint32_t address, std::uint32_t word) {
    const ProgramWord one[] = {{address, word}};
    parts_->core.load(one);
}

std::map<std::uint32_t, std::uint32_t> Chip::memory() const {
    const DeviceInfo& device = parts_->device;
    std::map<std::uint32_t, std::uint32_t> words;
    const auto add = [&](std::uint32_t start, std::uint32_t count, std::uint32_t erased) {
        for (std::uint32_t address = start; address < start + 2 * count; address += 2)
            if (const std::uint32_t word = parts_->core.program(address); word != erased)
                words.emplace(address, word);
    };
    constexpr std::uint32_t kErasedFlash = 0xFFFFFF, kErasedEeprom = 0xFFFF, kEveryWord = 0x1000000;
    add(0, device.flash_end / 2, kErasedFlash);
    add(device.unit_id_start, device.unit_id_words, kErasedFlash);
    add(device.eeprom_start, device.eeprom_words, kErasedEeprom);
    add(device.config_start, device.config_words, kEveryWord);
    return words;
}

void Chip::power_on() {
    if (parts_->core.program(0) == kErasedWord)
        parts_->report.warnings.push_back({0, "no program at the reset vector: address 0 is erased", 0});
    parts_->core.reset(ResetCause::PowerOn);
}

void Chip::mclr() {
    parts_->core.reset(ResetCause::Mclr);
}

void Chip::run_until(Time until) {
    Parts& parts = *parts_;
    parts.stopped_at.reset();
    if (parts.pause <= parts.now) parts.pause = cosim::kNever;
    parts.until = std::min(until, parts.pause);
    // The rate may change on the way: then the cycle that starts at `until` is another one.
    for (Cycle limit = parts.until_cycle();; limit = parts.until_cycle()) {
        const std::uint64_t before = parts.core.instructions();
        const Core::Outcome outcome = parts.core.run(limit);
        parts.instructions_run += parts.core.instructions() - before;
        if (outcome == Core::Outcome::Stopped) {
            parts.stopped_at = parts.core.pc();
            parts.arrive(std::min(parts.until, parts.clock.time_of(parts.core.cycle())));
            return;
        }
        if (parts.core.held_back()) {
            parts.until = std::min(parts.until, parts.clock.time_of(parts.core.cycle()));
            break;
        }
        if (parts.until_cycle() <= parts.core.cycle()) break;
    }
    parts.arrive(parts.until);
}

void Chip::pause_at(Time time) {
    parts_->pause = time;
    if (time >= parts_->until) return;
    parts_->until = time;
    parts_->core.end_run();
}

void Chip::stop_at(std::uint32_t pc) {
    parts_->stops.push_back(pc);
    parts_->core.set_stops(parts_->stops);
}

std::optional<std::uint32_t> Chip::stopped_at() const {
    return parts_->stopped_at;
}

void Chip::uart_receive(int unit, const cosim::UartFrame& frame) {
    parts_->uart(unit).receive(frame, parts_->message_cycle());
}

void Chip::i2c_answer(int unit, const cosim::I2cPhase& phase) {
    parts_->masters.at(static_cast<std::size_t>(unit - 1)).answer(phase, parts_->message_cycle());
}

void Chip::i2c_answer_at(int unit, const cosim::I2cPhase& phase, Time time) {
    const Cycle at = std::max(parts_->clock.first_cycle_at(time), parts_->core.cycle() + 1);
    parts_->masters.at(static_cast<std::size_t>(unit - 1)).answer_at(phase, at);
}

void Chip::edges_moved(Cycle at) {
    parts_->plan_edges(at == 0 ? 0 : at - 1);
}

void Chip::i2c_slave_phase(int unit, const cosim::I2cPhase& phase) {
    parts_->slaves.at(static_cast<std::size_t>(unit - 1)).phase(phase, parts_->message_cycle());
}

void Chip::stop_crystal() {
    Parts& parts = *parts_;
    if (parts.oscillator->crystal_stopped(parts.message_cycle())) return;
    parts.report.warnings.push_back(
        {parts.core.cycle(), "its crystal stopped, and no monitor watches it", pc()});
    parts.core.stall_until(kNoCycle);
}

void Chip::can_news(int unit, const cosim::CanMessage& message) {
    const auto module = static_cast<std::size_t>(unit - 1);
    if (!parts_->ecans.empty()) return parts_->ecans.at(module).news(message, parts_->message_cycle());
    parts_->cans.at(module).news(message, parts_->message_cycle());
}

void Chip::pins_changed(PortLetter port) {
    parts_->ports.outside_changed(port, parts_->message_cycle());
}

bool Chip::monitors(PortLetter port) const {
    return parts_->ports.monitors(port);
}

void Chip::supply_changed() {
    parts_->supply_changed();
}

Time Chip::earliest_uart_send(int unit, Time nominal_bit) const {
    const Time unbegun = now() + kUartLookaheadBits * nominal_bit;
    const std::optional<cosim::UartFrame> frame = parts_->uart(unit).begun();
    return frame ? std::min(unbegun, protocols::stop_bit_start(*frame)) : unbegun;
}

std::optional<Time> Chip::uart_begun(int unit) const {
    const std::optional<cosim::UartFrame> frame = parts_->uart(unit).begun();
    if (!frame) return std::nullopt;
    return frame->start;
}

UartCounters Chip::uart_counters(int unit) const {
    return parts_->uart(unit).counters();
}

bool Chip::uart_enabled(int unit) const {
    return parts_->uart(unit).enabled();
}

Time Chip::earliest_i2c(int unit) const {
    const I2cMaster& master = parts_->masters.at(static_cast<std::size_t>(unit - 1));
    const Cycle cycle = master.earliest(std::max(parts_->core.cycle(), parts_->message_cycle()));
    return cycle == kNoCycle ? cosim::kNever : parts_->clock.time_of(cycle);
}

Time Chip::earliest_i2c_slave_answer(int unit) const {
    const I2cSlave& slave = parts_->slaves.at(static_cast<std::size_t>(unit - 1));
    return slave.earliest_answer(std::max(parts_->core.cycle(), parts_->message_cycle()));
}

OutputCompareState Chip::output_compare(int unit) const {
    return parts_->output_compare->present(unit);
}

const cosim::ClockDomain& Chip::clock() const {
    return parts_->clock;
}

Time Chip::now() const {
    return parts_->now;
}

Cycle Chip::cycle() const {
    return parts_->core.cycle();
}

std::uint32_t Chip::pc() const {
    return parts_->core.pc();
}

const image::CodePlaces& Chip::places() const {
    return parts_->places;
}

std::uint16_t Chip::peek(std::string_view register_name) const {
    const RegisterInfo* info = parts_->sfr.find(register_name);
    if (!info) throw std::out_of_range("no register " + std::string(register_name));
    parts_->ports.refresh();
    for (Timer& timer : parts_->timers)
        timer.refresh();
    return parts_->sfr.quiet_read(info->address);
}

std::uint16_t Chip::peek_data(std::uint16_t address) const {
    const DeviceInfo& device = parts_->device;
    if (address < device.ram_start || address >= device.ram_end || address % 2)
        throw std::out_of_range("no RAM word at this address");
    return parts_->core.ram()[(address - device.ram_start) / 2u];
}

std::size_t Chip::resets() const {
    return parts_->report.resets.size();
}

Chip::Inside Chip::inside() {
    Parts& parts = *parts_;
    return {parts.device, parts.core, parts.sfr, parts.interrupts, parts.clock, parts.held};
}

void Chip::set_stops(const std::vector<std::uint32_t>& addresses) {
    parts_->stops = addresses;
    parts_->core.set_stops(parts_->stops);
}

void Chip::set_skipping(bool on) {
    parts_->core.set_skip_idle(on);
    parts_->interrupts.set_resting(on);
}

}  // namespace puckloop::dspic
