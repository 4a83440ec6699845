#include "emu/rab_board/rab_node.h"

#include "base/json.h"
#include "emu/rab_board/rab_json.h"

#include <algorithm>

namespace puckloop::rab {

RabNode::RabNode(const image::Image& image, const RabNodeOptions& options)
    : DspicNode(options.board, static_cast<BoardListener&>(*this),
                {{"uart1", cosim::PortKind::Uart},
                 {"uart2", cosim::PortKind::Uart},
                 {"i2c", cosim::PortKind::I2c},
                 {"ir", cosim::PortKind::Signals},
                 {"world", cosim::PortKind::Signals}},
                {}, options.log, image),
      options_(options),
      i2c_times_(options.fastest_i2c_hertz) {
    can_.add(options.board.can, ports_);
    dspic::ChipOptions chip_options;
    chip_options.crystal_hertz = options.board.crystal_hertz;
    chip_options.ppm = options.board.crystal_ppm;
    chip_ = std::make_unique<dspic::Chip>(dspic::dspic33fj256gp710(), board_, chip_options);
    board_.connect(*chip_);
    gate_.emplace(*chip_, Board::looks_at_light(), Board::other_modules());
    switch_on(image, options.skip_idle, options.faults);
}

/// What the board does by itself before `until`.
void RabNode::settle(cosim::Time until) {
    if (until > 0) board_.settle(until - 1);
}

/// The chip notices no edges of light, and no fault draws which burst it loses when it comes.
bool RabNode::looks_by_program() const {
    return !faults_ && !chip_->monitors(Board::kDemodulators);
}

/// It holds SCL until it has answered, and the bus can say nothing.
bool RabNode::has_turn() const {
    return answers() && looks_by_program() && gate_->applies();
}

cosim::Time RabNode::advance_sampling(const cosim::SampledReach& reach, std::span<const cosim::Message> inbox,
                                      std::vector<cosim::Message>& outbox) {
    if (!looks_by_program() || !gate_->applies()) {
        const cosim::Time until = std::max(granted_, std::min(reach.until, reach.known));
        const auto end = std::find_if(inbox.begin(), inbox.end(),
                                      [until](const cosim::Message& m) { return m.time >= until; });
        advance(until, {inbox.begin(), end}, outbox);
        return until;
    }
    outbox_ = &outbox;
    gate_->open(reach.known);
    if (answers()) turn_.begin(reach.answered);
    for (const cosim::Message& message : inbox) {
        if (takes_ahead(message)) continue;
        run_until(message.time);
        if (held_back()) break;
        receive(message);
    }
    if (!held_back()) run_until(reach.until);
    granted_ = held_back() ? chip_->now() : reach.until;
    chip_->pause_at(cosim::kNever);
    turn_.end();
    gate_->lift();
    settle(granted_);
    outbox_ = nullptr;
    return granted_;
}

/// Light shows where the program looks.
bool RabNode::takes_ahead(const cosim::Message& message) {
    const auto* signal = std::get_if<cosim::Signal>(&message.payload);
    if (signal == nullptr || !Board::is_light(signal->id) || !looks_by_program()) return false;
    double value = signal->value;
    if (signal->id < kPeak) {
        const bool carrier = value != 0.0;
        note_carrier(signal->id - kDemodulator, carrier);
        value = carrier ? 1.0 : 0.0;
    }
    board_.light_arrives(signal->id, value, message.time);
    return true;
}

void RabNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
        receive_uart(message, *frame);
    else if (const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload))
        receive_i2c(*phase, message.time);
    else if (const auto* can = std::get_if<cosim::CanMessage>(&message.payload))
        receive_can(message, *can);
    else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload))
        receive_signal(*signal, message.time);
}

void RabNode::receive_signal(const cosim::Signal& signal, cosim::Time now) {
    board_.show_light(now);
    const int receiver = signal.id - kDemodulator;
    if (receiver >= 0 && receiver < kSensorCount) {
        note_carrier(receiver,
                     signal.value != 0.0 && !(faults_ && faults_->loses_burst(false, receiver + 1, now)));
        show_carrier(receiver, now);
    } else if (const auto port = board_.set_signal(signal.id, signal.value, now)) {
        chip_->pins_changed(*port);
    } else if (Board::is_supply(signal.id)) {
        chip_->supply_changed();
    }
}

void RabNode::note_carrier(int receiver, bool seen) {
    const auto bit = static_cast<std::uint16_t>(1u << receiver);
    own_.seen = static_cast<std::uint16_t>(seen ? own_.seen | bit : own_.seen & ~bit);
}

void RabNode::receive_i2c(const cosim::I2cPhase& phase, cosim::Time now) {
    const cosim::I2cPhase held = i2c_times_.held(phase, now);
    if (phase.kind != cosim::I2cPhaseKind::Acknowledge) log_.i2c_phase(held, now);
    chip_->i2c_slave_phase(kI2cUnit, held);
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

cosim::Time RabNode::earliest_output(cosim::PortIndex port) const {
    if (port == kWorld) return cosim::kNever;
    return port == kI2c ? earliest_answer() : granted_;
}

cosim::Time RabNode::lookahead(cosim::PortIndex port) const {
    if (port == kWorld) return cosim::kNever;
    return port == kI2c && !answers() ? i2c_times_.lookahead() : 0;
}

void RabNode::signal_changed(SignalId id, double value, cosim::Time now) {
    log_.signal_changed(id, value, now);
    const int emitter = id - kEmitter;
    const bool begins = faults_ && emitter >= 0 && emitter < kSensorCount && value != 0.0;
    if (begins && faults_->loses_burst(true, emitter + 1, now)) return;
    if (id < kPeakReset) outbox_->push_back({now, kIr, cosim::Signal{id, value}});
}

void RabNode::i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) {
    log_.i2c_answer(answer, now);
    outbox_->push_back({reached(now), kI2c, answer});
    turn_.said(*chip_, now, chip_->now());
}

/// A device port cannot carry it: the firmware waits for an answer for ever, and the report states it.
void RabNode::i2c_phase(int /*unit*/, const cosim::I2cPhase& /*phase*/) {
    ++own_.master_phases;
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
