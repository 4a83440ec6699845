#include "emu/pic/pic_node.h"

#include "base/json.h"
#include "cosim/i2c/i2c_shared.h"
#include "emu/board/chip_json.h"
#include "emu/camera/frame_log.h"

#include <algorithm>

namespace puckloop::pic {

namespace {
constexpr std::uint8_t kNobody = 0xFF;  // the bus at rest
}  // namespace

PicNode::PicNode(const image::Image& image, const PicNodeOptions& options)
    : DspicNode(options.board, static_cast<BoardListener&>(*this),
                {{"uart1", cosim::PortKind::Uart},
                 {"uart2", cosim::PortKind::Uart},
                 {"i2c", cosim::PortKind::I2c},
                 {"world", cosim::PortKind::Signals}},
                options.resets, options.log, image),
      options_(options),
      i2c_times_(options.fastest_i2c_hertz) {
    if (options.ircom) ports_.push_back({"ir", cosim::PortKind::Signals});
    can_.add(options.board.can, ports_);
    if (options.i2c_slave) {
        slave_port_ = static_cast<cosim::PortIndex>(ports_.size());
        ports_.push_back({"i2c_slave", cosim::PortKind::I2c});
    }
    if (options.camera) {
        if (options.i2c_linked) ports_.push_back({"camera_i2c", cosim::PortKind::I2c});
        ports_.push_back({"camera", cosim::PortKind::Signals});
        board_.fit_camera(*options.camera, *options_.scenery);
        followers_.scenery = options_.scenery.get();
    }
    dspic::ChipOptions chip_options;
    chip_options.crystal_hertz = options.board.crystal_hertz;
    chip_options.ppm = options.board.crystal_ppm;
    chip_options.fosc = options.fosc;
    chip_options.errata = options.board.errata;
    chip_ = std::make_unique<dspic::Chip>(dspic::dspic30f6014a(), board_, chip_options);
    switch_on(image, options.skip_idle, options.faults);
}

/// Steps due before `until` are sent now; one that is due later may still be undone by an instruction.
void PicNode::settle(cosim::Time until) {
    const dspic::Cycle next = chip_->clock().first_cycle_at(until);
    if (next > 0) board_.settle(next - 1);
}

void PicNode::run_board(cosim::Time until) {
    if (options_.i2c_linked) return DspicNode::run_board(std::min(until, turn_.limit()));
    while (chip_->now() < until) {
        const cosim::Time step = std::min(until, std::max(bus_.due(), chip_->now()));
        if (step > chip_->now()) DspicNode::run_board(step);
        if (bus_.due() <= chip_->now()) chip_->i2c_answer(kI2cUnit, bus_.take());
    }
}

std::optional<cosim::PortIndex> PicNode::turn_port() const {
    if (!options_.i2c_linked || options_.i2c_slave) return std::nullopt;
    return kI2c;
}

/// The bus speaks to a master that waits for an answer, and to no other.
bool PicNode::has_turn() const {
    return turn_port() && !faults_ && !next_reset() && chip_->earliest_i2c(kI2cUnit) != cosim::kNever;
}

cosim::Time PicNode::advance_sampling(const cosim::SampledReach& reach, std::span<const cosim::Message> inbox,
                                      std::vector<cosim::Message>& outbox) {
    if (!has_turn()) {
        advance(reach.until, inbox, outbox);
        return reach.until;
    }
    outbox_ = &outbox;
    turn_.begin(reach.answered);
    for (const cosim::Message& message : inbox) {
        run_until(message.time);
        if (held_back()) break;
        receive(message);
    }
    if (!held_back()) run_until(reach.until);
    granted_ = chip_->now();
    chip_->pause_at(cosim::kNever);
    turn_.end();
    settle(granted_);
    outbox_ = nullptr;
    return granted_;
}

void PicNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
        receive_uart(message, *frame);
    } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload)) {
        if (is_camera_bus(message.port)) return camera_phase(*phase, message.time);
        if (is_slave(message.port))
            return chip_->i2c_slave_phase(kI2cUnit, i2c_times_.held(*phase, message.time));
        chip_->i2c_answer(kI2cUnit, *phase);
    } else if (const auto* can = std::get_if<cosim::CanMessage>(&message.payload)) {
        receive_can(message, *can);
    } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        receive_signal(message, *signal);
    }
}

void PicNode::receive_signal(const cosim::Message& message, const cosim::Signal& signal) {
    if (options_.camera && message.port == camera_port())
        return options_.scenery->change(signal.id, signal.value);
    const dspic::Cycle now = chip_->clock().first_cycle_at(message.time);
    if (signal.id == kResetButton && signal.value > board_.signal(kResetButton)) chip_->mclr();
    if (const auto port = board_.set_signal(signal.id, signal.value, now)) chip_->pins_changed(*port);
    if (signal.id == kBatteryVoltage) chip_->supply_changed();
}

void PicNode::i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) {
    if (options_.i2c_slave) outbox_->push_back({reached(now), slave_port_, answer});
}

/// The bus reports a phase half a clock before the answer is due: the camera is prompt
/// (cosim/i2c/i2c_bus.h).
cosim::Time PicNode::camera_lookahead() const {
    return i2c_times_.fastest_period() / 2;
}

cosim::Time PicNode::lookahead(cosim::PortIndex port) const {
    if (is_camera_bus(port)) return camera_lookahead();
    return is_slave(port) && !answers() ? i2c_times_.lookahead() : 0;
}

/// The camera never stretches: its answer is known at once, and due when the eighth clock ends.
void PicNode::camera_phase(const cosim::I2cPhase& phase, cosim::Time now) {
    const cosim::Time due = std::max(
        now + camera_lookahead(), phase.start + board::I2cDeviceTimes::kClocksToAnswer * phase.clock_period);
    const dspic::Cycle written = chip_->clock().first_cycle_at(due + phase.clock_period);
    const std::optional<cosim::I2cPhase> answer = board_.camera_i2c(phase, written);
    if (phase.kind == cosim::I2cPhaseKind::Stop) return;
    cosim::I2cPhase none = phase;
    none.kind = phase.kind == cosim::I2cPhaseKind::Read ? cosim::I2cPhaseKind::Data
                                                        : cosim::I2cPhaseKind::Acknowledge;
    none.byte = phase.kind == cosim::I2cPhaseKind::Read ? kNobody : phase.byte;
    none.ack = 0;
    outbox_->push_back({due, camera_bus_port(), answer.value_or(none)});
}

cosim::Time PicNode::earliest_output(cosim::PortIndex port) const {
    if (is_camera_bus(port)) return cosim::kNever;
    if (is_slave(port)) return earliest_answer();
    if (port == kI2c) {
        const cosim::Time earliest = chip_->earliest_i2c(kI2cUnit);
        return std::max(granted_, faults_ ? std::min(earliest, faults_->earliest(granted_)) : earliest);
    }
    return granted_;
}

void PicNode::signal_changed(SignalId id, double value, dspic::Cycle now) {
    const cosim::Time time = chip_->clock().time_of(now);
    log_.signal_changed(id, value, time);
    outbox_->push_back({time, kWorld, cosim::Signal{id, value}});
    if (options_.ircom && id >= kPulse && id < kPulse + kPulseCount)
        outbox_->push_back({time, kIr, cosim::Signal{id, value}});
}

void PicNode::i2c_phase(int unit, const cosim::I2cPhase& phase) {
    if (unit != kI2cUnit) return;
    if (options_.i2c_linked) {
        outbox_->push_back({reached(phase.start), kI2c, phase});
        turn_.said(*chip_, phase.start, chip_->now());
        return;
    }
    const cosim::Time answered = dspic::i2c_ninth_clock_end(phase);
    // The camera, which alone may be here, follows whole bytes only.
    if (phase.kind == cosim::I2cPhaseKind::BusLost) return;
    if (phase.kind == cosim::I2cPhaseKind::Acknowledge || phase.kind == cosim::I2cPhaseKind::Data) {
        if (phase.ack != 0) chip_->i2c_answer_at(unit, cosim::free_line(phase), answered);
        return;
    }
    const Board::OwnPhase own = board_.own_i2c(phase, chip_->clock().first_cycle_at(answered));
    if (own.answer) chip_->i2c_answer_at(unit, *own.answer, answered);
    if (!own.ours) chip_->pause_at(bus_.phase(phase));
}

void PicNode::line_pulled_low(dspic::Cycle now) {
    if (!options_.uart1_breaks || chip_->uart_enabled(1) || outbox_ == nullptr) return;
    cosim::UartFrame frame;
    frame.start = chip_->clock().time_of(now);
    constexpr cosim::Time kBit = 8'680'556;  // ps: 115200 baud
    frame.bit_period = kBit;
    frame.is_break = 1;
    send_uart(1, frame);
}

void PicNode::step_lost(int motor, dspic::Cycle now) {
    if (faults_) faults_->lost_step(motor, chip_->clock().time_of(now));
}

void PicNode::set_sag(double volts) {
    if (const auto port = board_.set_sag(volts, message_cycle())) chip_->pins_changed(*port);
    chip_->supply_changed();
}

void PicNode::set_battery(std::optional<double> volts) {
    if (const auto port = board_.set_battery(volts, message_cycle())) chip_->pins_changed(*port);
    chip_->supply_changed();
}

void PicNode::set_motor(int motor, std::uint8_t open, bool stalled) {
    board_.set_held(motor, open != 0 || stalled, message_cycle());
}

std::string PicNode::finish() {
    log_.end(granted_, *chip_, board_);
    if (options_.nvm) options_.nvm->save(chip_->memory());
    if (board_.camera() && !options_.camera_log.empty())
        camera::write_frame_log(options_.camera_log, *board_.camera(), chip_->clock());
    nlohmann::ordered_json json = board::chip_json(*chip_);
    json["kind"] = "epuck board, dsPIC30F6014A";
    json["wheel_steps"] = {{"left", board_.left_motor().steps()}, {"right", board_.right_motor().steps()}};
    json["illegal_coil_patterns"] =
        board_.left_motor().illegal_patterns() + board_.right_motor().illegal_patterns();
    json["uart1"] = board::uart_json(chip_->uart_counters(1));
    json["uart2"] = board::uart_json(chip_->uart_counters(2));
    if (board_.camera())
        json["camera"] = nlohmann::ordered_json::parse(camera::report_json(*board_.camera()));
    if (!options_.faults.empty())
        json["faults"] = board::fault_report(*faults_, board_.analog_faults(), granted_);
    return json.dump();
}

}  // namespace puckloop::pic
