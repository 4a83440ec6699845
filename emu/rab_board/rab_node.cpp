#include "emu/rab_board/rab_node.h"

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
             {"ir", cosim::PortKind::Signals}},
      board_(options.board, *this),
      log_(options.log, image) {
    dspic::ChipOptions chip_options;
    chip_options.crystal_hertz = options.board.crystal_hertz;
    chip_options.ppm = options.board.crystal_ppm;
    chip_ = std::make_unique<dspic::Chip>(dspic::dspic33fj256gp710(), board_, chip_options);
    board_.connect(*chip_);
    chip_->set_skipping(options.skip_idle);
    chip_->load(image);
    chip_->power_on();
}

void RabNode::advance(cosim::Time until, std::span<const cosim::Message> inbox,
                      std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        run_until(message.time);
        receive(message);
    }
    run_until(until);
    settle(until);
    granted_ = until;
    outbox_ = nullptr;
}

/// What the board does by itself before `until`.
void RabNode::settle(cosim::Time until) {
    if (until > 0) board_.settle(until - 1);
}

void RabNode::run_until(cosim::Time until) {
    while (log_.next_look() <= until) {
        chip_->run_until(log_.next_look());
        settle(log_.next_look());
        log_.look(*chip_);
    }
    chip_->run_until(until);
}

void RabNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
        const int unit = uart_unit(message.port);
        log_.arrived(unit, *frame, message.time, chip_->uart_enabled(unit));
        chip_->uart_receive(unit, *frame);
    } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload)) {
        begin_i2c(*phase, message.time);
    } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        if (const auto port = board_.set_signal(signal->id, signal->value, message.time))
            chip_->pins_changed(*port);
    }
}

/// Holds what lookahead() guarantees: no answer before that long after the phase came in. A bus that passes a
/// phase on late, or a master faster than the fastest, moves the phase.
void RabNode::begin_i2c(cosim::I2cPhase phase, cosim::Time now) {
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
    if (port == kI2c) return std::max(granted_, chip_->earliest_i2c_slave_answer(kI2cUnit));
    return granted_;
}

cosim::Time RabNode::lookahead(cosim::PortIndex port) const {
    const bool idle = chip_->earliest_i2c_slave_answer(kI2cUnit) == cosim::kNever;
    return port == kI2c && idle ? lookahead_when_idle() : 0;
}

std::optional<cosim::Time> RabNode::begun(cosim::PortIndex port) const {
    if (port != kUart1 && port != kUart2) return std::nullopt;
    return chip_->uart_begun(uart_unit(port));
}

void RabNode::signal_changed(SignalId id, double value, cosim::Time now) {
    log_.signal_changed(id, value, now);
    if (id < kPeakReset) outbox_->push_back({now, kIr, cosim::Signal{id, value}});
}

void RabNode::uart_sent(int unit, const cosim::UartFrame& frame) {
    const cosim::Time stop_bit = protocols::stop_bit_start(frame);
    log_.sent(unit, frame, stop_bit);
    outbox_->push_back({stop_bit, unit == 1 ? kUart1 : kUart2, frame});
}

void RabNode::i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) {
    log_.i2c_answer(answer, now);
    outbox_->push_back({now, kI2c, answer});
}

/// A device port cannot carry it: the firmware waits for an answer for ever, and the report says so.
void RabNode::i2c_phase(int /*unit*/, const cosim::I2cPhase& /*phase*/) {
    ++master_phases_;
}

void RabNode::state(StateWriter& archive) const {
    board::save_node(archive, granted_, master_phases_, board_, *chip_, log_);
}

void RabNode::state(StateReader& archive) {
    board::load_node(archive, granted_, master_phases_, board_, *chip_, log_);
}

void RabNode::state(CheckpointWriter& archive) const {
    board::save_node(archive, granted_, master_phases_, board_, *chip_, log_);
}

void RabNode::state(CheckpointReader& archive) {
    archive(granted_, master_phases_, board_, *chip_, log_);
}

std::string RabNode::finish() {
    log_.end(granted_, *chip_);
    if (options_.nvm) options_.nvm->save(chip_->memory());
    nlohmann::ordered_json json = rab_json(*chip_, board_, log_);
    json["i2c"]["master_phases"] = master_phases_;
    return json.dump();
}

}  // namespace puckloop::rab
