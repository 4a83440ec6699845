#include "emu/rab_board/rab_node.h"

#include "emu/board/fault_parts.h"
#include "emu/rab_board/rab_json.h"
#include "protocols/uart_sampling.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace puckloop::rab {

namespace {

constexpr cosim::Time kClocksToAnswer = 8;

int uart_unit(cosim::PortIndex port) {
    return port == RabNode::kUart1 ? 1 : 2;
}

}  // namespace

RabNode::RabNode(const image::Image& image, const RabNodeOptions& options)
    : options_(options),
      fastest_period_(static_cast<cosim::Time>(
          std::llround(static_cast<double>(cosim::kSecond) / options.fastest_i2c_hertz))),
      ports_{{"uart1", cosim::PortKind::Uart},
             {"uart2", cosim::PortKind::Uart},
             {"i2c", cosim::PortKind::I2c},
             {"ir", cosim::PortKind::Signals},
             {"world", cosim::PortKind::Signals}},
      board_(options.board, *this),
      log_(options.log, image) {
    can_.add(options.board.can, ports_);
    dspic::ChipOptions chip_options;
    chip_options.crystal_hertz = options.board.crystal_hertz;
    chip_options.ppm = options.board.crystal_ppm;
    chip_ = std::make_unique<dspic::Chip>(dspic::dspic33fj256gp710(), board_, chip_options);
    board_.connect(*chip_);
    chip_->set_skipping(options.skip_idle);
    chip_->load(image);
    chip_->power_on();
    if (options.faults.empty()) return;
    chip_faults_.emplace(*chip_);
    faults_ = board::make_faults(options.faults,
                                 {*chip_faults_, static_cast<chip::BoardAccess&>(*this),
                                  board_.analog_faults(), chip_->clock(), options.board.crystal_ppm},
                                 board::symbols_of(image));
}

void RabNode::advance(cosim::Time until, std::span<const cosim::Message> inbox,
                      std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        run_faults(message.time, true);
        run_until(message.time);
        receive(message);
    }
    run_faults(until, false);
    run_until(until);
    settle(until);
    granted_ = until;
    outbox_ = nullptr;
}

/// What the board does by itself before `until`.
void RabNode::settle(cosim::Time until) {
    if (until > 0) board_.settle(until - 1);
}

void RabNode::run_faults(cosim::Time until, bool inclusive) {
    board::act_until(faults_.get(), until, inclusive, [this](cosim::Time time) { run_until(time); });
}

void RabNode::run_until(cosim::Time until) {
    while (log_.next_look() <= until) {
        board::run_past_faults(*chip_, faults_.get(), log_.next_look());
        settle(log_.next_look());
        log_.look(*chip_);
    }
    board::run_past_faults(*chip_, faults_.get(), until);
}

void RabNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
        const int unit = uart_unit(message.port);
        log_.arrived(unit, *frame, message.time, chip_->uart_enabled(unit));
        chip_->uart_receive(unit, *frame);
    } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload)) {
        begin_i2c(*phase, message.time);
    } else if (const auto* can = std::get_if<cosim::CanMessage>(&message.payload)) {
        chip_->can_news(can_.unit_of(message.port), *can);
    } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        const int receiver = signal->id - kDemodulator;
        if (receiver >= 0 && receiver < kSensorCount) {
            const auto bit = static_cast<std::uint16_t>(1u << receiver);
            const bool begins =
                signal->value != 0.0 && !(faults_ && faults_->loses_burst(false, receiver + 1, message.time));
            own_.seen = static_cast<std::uint16_t>(begins ? own_.seen | bit : own_.seen & ~bit);
            show_carrier(receiver, message.time);
        } else if (const auto port = board_.set_signal(signal->id, signal->value, message.time)) {
            chip_->pins_changed(*port);
        } else if (Board::is_supply(signal->id)) {
            chip_->supply_changed();
        }
    }
}

void RabNode::set_sag(double volts) {
    board_.set_sag(volts);
    chip_->supply_changed();
}

void RabNode::set_battery(std::optional<double> volts) {
    board_.set_battery(volts);
    chip_->supply_changed();
}

void RabNode::set_carrier(std::uint16_t receivers) {
    own_.foreign = receivers;
    for (int receiver = 0; receiver < kSensorCount; ++receiver)
        show_carrier(receiver, chip_->now());
}

void RabNode::show_carrier(int receiver, cosim::Time now) {
    const bool lit = (own_.seen | own_.foreign) >> receiver & 1;
    const auto id = static_cast<SignalId>(kDemodulator + receiver);
    if (const auto port = board_.set_signal(id, lit ? 1.0 : 0.0, now)) chip_->pins_changed(*port);
}

/// Holds what lookahead() guarantees: no answer before that long after the phase came in. A bus that passes a
/// phase on late, or a master faster than the fastest, moves the phase.
void RabNode::begin_i2c(cosim::I2cPhase phase, cosim::Time now) {
    if (phase.kind == cosim::I2cPhaseKind::Acknowledge) return chip_->i2c_slave_phase(kI2cUnit, phase);
    if (phase.kind != cosim::I2cPhaseKind::Stop) {
        phase.clock_period = std::max(phase.clock_period, fastest_period_);
        const cosim::Time earliest = now + lookahead_when_idle() - kClocksToAnswer * phase.clock_period;
        phase.start = std::max(phase.start, earliest);
    }
    log_.i2c_phase(phase, now);
    chip_->i2c_slave_phase(kI2cUnit, phase);
}

/// The bus hands a phase on half a clock late at most.
cosim::Time RabNode::lookahead_when_idle() const {
    return kClocksToAnswer * fastest_period_ - fastest_period_ / 2;
}

cosim::Time RabNode::earliest_output(cosim::PortIndex port) const {
    if (port == kWorld) return cosim::kNever;
    if (port == kI2c) {
        const cosim::Time earliest = chip_->earliest_i2c_slave_answer(kI2cUnit);
        return std::max(granted_, faults_ && earliest != cosim::kNever
                                      ? std::min(earliest, faults_->earliest(granted_))
                                      : earliest);
    }
    return granted_;
}

cosim::Time RabNode::lookahead(cosim::PortIndex port) const {
    if (port == kWorld) return cosim::kNever;
    const bool idle = chip_->earliest_i2c_slave_answer(kI2cUnit) == cosim::kNever;
    return port == kI2c && idle ? lookahead_when_idle() : 0;
}

std::optional<cosim::Time> RabNode::begun(cosim::PortIndex port) const {
    if (port != kUart1 && port != kUart2) return std::nullopt;
    return chip_->uart_begun(uart_unit(port));
}

void RabNode::signal_changed(SignalId id, double value, cosim::Time now) {
    log_.signal_changed(id, value, now);
    const int emitter = id - kEmitter;
    const bool begins = faults_ && emitter >= 0 && emitter < kSensorCount && value != 0.0;
    if (begins && faults_->loses_burst(true, emitter + 1, now)) return;
    if (id < kPeakReset) outbox_->push_back({now, kIr, cosim::Signal{id, value}});
}

void RabNode::uart_sent(int unit, const cosim::UartFrame& frame) {
    const cosim::Time stop_bit = protocols::stop_bit_start(frame);
    log_.sent(unit, frame, stop_bit);
    const cosim::Time time = board::reached(*chip_, faults_.get(), stop_bit);
    outbox_->push_back({time, unit == 1 ? kUart1 : kUart2, frame});
}

void RabNode::i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) {
    log_.i2c_answer(answer, now);
    outbox_->push_back({board::reached(*chip_, faults_.get(), now), kI2c, answer});
}

/// A device port cannot carry it: the firmware waits for an answer for ever, and the report states it.
void RabNode::i2c_phase(int /*unit*/, const cosim::I2cPhase& /*phase*/) {
    ++own_.master_phases;
}

void RabNode::can_to_bus(int unit, const cosim::CanMessage& message) {
    outbox_->push_back({board::reached(*chip_, faults_.get(), message.start), can_.port_of(unit), message});
}

void RabNode::state(StateWriter& archive) const {
    board::save_node(archive, granted_, own_, board_, *chip_, log_);
    board::save_faults(archive, faults_.get());
}

void RabNode::state(StateReader& archive) {
    board::load_node(archive, granted_, own_, board_, *chip_, log_);
    board::load_faults(archive, faults_, granted_, [this] {
        chip_faults_.emplace(*chip_);
        return std::make_unique<chip::BoardFaults>(std::vector<cosim::CarriedFault>{}, *chip_faults_,
                                                   static_cast<chip::BoardAccess&>(*this), chip::Symbols{},
                                                   options_.board.crystal_ppm);
    });
}

void RabNode::state(CheckpointWriter& archive) const {
    board::save_node(archive, granted_, own_, board_, *chip_, log_);
    if (faults_) archive(*faults_);
}

void RabNode::state(CheckpointReader& archive) {
    archive(granted_, own_, board_, *chip_, log_);
    if (faults_) archive(*faults_);
}

void RabNode::add_work(cosim::WorkCounts& counts) const {
    chip_->add_work(counts);
    counts.emplace_back("bytes copied for going back", mark_.bytes());
}

std::string RabNode::finish() {
    log_.end(granted_, *chip_);
    if (options_.nvm) options_.nvm->save(chip_->memory());
    nlohmann::ordered_json json = rab_json(*chip_, board_, log_);
    json["i2c"]["master_phases"] = own_.master_phases;
    if (!options_.faults.empty())
        json["faults"] = board::fault_report(*faults_, board_.analog_faults(), granted_);
    return json.dump();
}

}  // namespace puckloop::rab
