#include "emu/tam_avr/tam_node.h"

#include "emu/board/fault_parts.h"
#include "emu/tam_avr/fuse_check.h"
#include "emu/tam_avr/tam_json.h"
#include "protocols/uart_sampling.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace puckloop::tam {

namespace {

using cosim::Time;

int unit_of(cosim::PortIndex port) {
    return port == TamNode::kConsole ? kConsoleUnit : kXBeeUnit;
}

/// Where a change of an output is of interest outside.
std::optional<cosim::PortIndex> port_of(SignalId id) {
    if (id == kProximityEmit) return TamNode::kIr;
    if (id == kXBeeReset || id == kXBeeRts || id == kXBeeWake || id == kPower) return TamNode::kPins;
    const bool led = id >= kLed && id < kLed + kLeds;
    const bool infrared = id == kLed + kInfraredLeft || id == kLed + kInfraredRight;
    if (led && !infrared) return TamNode::kWorld;
    return std::nullopt;
}

}  // namespace

TamNode::TamNode(const image::AvrImage& image, const TamNodeOptions& options)
    : options_(options),
      ports_{{"console", cosim::PortKind::Uart},
             {"xbee", cosim::PortKind::Uart},
             {"pins", cosim::PortKind::Signals},
             {"world", cosim::PortKind::Signals},
             {"ir", cosim::PortKind::Signals}},
      log_(options.log, image, options.start),
      board_(std::make_unique<Board>(options.board, static_cast<BoardListener&>(*this))) {
    board_->chip().set_skipping(options.skip_idle);
    board_->set_signal(kBattery, options.battery);
    // XBEE_NET_1 is the lower bit.
    board_->set_signal(kNetworkSwitch, options.network & 2 ? 1.0 : 0.0);
    board_->set_signal(kNetworkSwitch + 1, options.network & 1 ? 1.0 : 0.0);
    board_->load(image);
    warnings_ = fuse_warnings(board_->chip().fuses(), image);
    if (options.faults.empty()) return;
    chip_faults_.emplace(board_->chip());
    faults_ =
        board::make_faults(options.faults,
                           {*chip_faults_, static_cast<chip::BoardAccess&>(*this), board_->analog_faults(),
                            board_->chip().clock(), options.board.resonator_ppm, options.start},
                           board::symbols_of(image));
}

void TamNode::advance(Time until, std::span<const cosim::Message> inbox,
                      std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        press_reset(message.time, true);
        run_faults(message.time, true);
        run_until(message.time);
        receive(message);
    }
    // A press at `until` itself belongs to the next grant: what this one sends must not depend on the cut.
    press_reset(until, false);
    run_faults(until, false);
    run_until(until);
    granted_ = until;
    outbox_ = nullptr;
}

void TamNode::press_reset(std::vector<cosim::Message>& outbox) {
    auto* const before = std::exchange(outbox_, &outbox);
    board_->reset_now(before != nullptr);
    outbox_ = before;
}

void TamNode::press_reset(Time until, bool inclusive) {
    while (next_reset_ < options_.resets.size()) {
        const Time time = options_.resets[next_reset_];
        if (time > until || (time == until && !inclusive)) return;
        run_faults(time, false);
        run_until(time);
        board_->reset_button();
        ++next_reset_;
    }
}

void TamNode::run_faults(Time until, bool inclusive) {
    board::act_until(faults_.get(), until, inclusive, [this](Time time) { run_until(time); });
}

void TamNode::run_board(Time until) {
    board_->run_until(until);
    if (!faults_) return;
    while (board_->powered() && board_->chip().stopped_at()) {
        faults_->arrived(from_board(board_->now()));
        board_->run_until(until);
    }
}

void TamNode::run_until(Time until) {
    while (log_.next_look() <= until) {
        run_board(to_board(log_.next_look()));
        log_.look(board_->chip());
    }
    run_board(to_board(until));
}

void TamNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
        if (message.time < options_.start) return;
        cosim::UartFrame moved = *frame;
        moved.start -= options_.start;
        const int unit = unit_of(message.port);
        log_.arrived(unit, *frame, message.time, board_->powered() && board_->chip().uart_listens(unit));
        board_->uart_receive(unit, moved);
    } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        if (signal->id >= kSignalCount) return;
        board_->set_signal(signal->id, signal->value);
        log_.input(signal->id, board_->signal(signal->id), message.time);
    }
}

Time TamNode::earliest_output(cosim::PortIndex /*port*/) const {
    Time next = std::max(options_.start, cosim::later(board_->wakes(), options_.start));
    if (board_->powered() && next_reset_ < options_.resets.size())
        next = std::min(next, options_.resets[next_reset_]);
    if (board_->powered() && faults_) next = std::min(next, faults_->earliest(granted_));
    return std::max(granted_, next);
}

Time TamNode::lookahead(cosim::PortIndex /*port*/) const {
    return board_->powered() ? 0 : cosim::kNever;
}

std::optional<Time> TamNode::begun(cosim::PortIndex port) const {
    if ((port != kConsole && port != kXBee) || !board_->powered()) return std::nullopt;
    const auto start = board_->chip().uart_begun(unit_of(port));
    if (!start) return std::nullopt;
    return from_board(*start);
}

void TamNode::signal_changed(SignalId id, double value, Time now) {
    const Time time = from_board(now);
    log_.signal_changed(id, value, time);
    if (outbox_ == nullptr) return;  // the levels that the board begins with
    const std::optional<cosim::PortIndex> port = port_of(id);
    if (!port || (port == kPins && !options_.pins_linked) || (port == kIr && !options_.ir_linked)) return;
    outbox_->push_back({time, *port, cosim::Signal{id, value}});
}

void TamNode::uart_sent(int unit, const cosim::UartFrame& frame) {
    cosim::UartFrame moved = frame;
    moved.start = from_board(frame.start);
    const Time stop_bit = protocols::stop_bit_start(moved);
    log_.sent(unit, moved, stop_bit);
    Time time = stop_bit;
    if (faults_ && faults_->clock_changed(stop_bit))
        time = std::max(time, from_board(board_->chip().clock().time_of(board_->chip().cycle())));
    outbox_->push_back({time, unit == kConsoleUnit ? kConsole : kXBee, moved});
}

void TamNode::state(StateWriter& archive) const {
    archive(granted_);
    archive.part("board", *board_);
    archive.part("log", log_);
    board::save_faults(archive, faults_.get());
}

void TamNode::state(StateReader& archive) {
    archive.bounded(granted_, 0, cosim::kNever);
    archive.part("board", *board_);
    archive.part("log", log_);
    archive.check(board_->now() == to_board(granted_), "node and board at different times");
    log_.loaded(granted_);
    // A press at the very time of the state is still to come.
    const auto next = std::lower_bound(options_.resets.begin(), options_.resets.end(), granted_);
    next_reset_ = static_cast<std::size_t>(next - options_.resets.begin());
    board::load_faults(archive, faults_, granted_, [this] {
        chip_faults_.emplace(board_->chip());
        return std::make_unique<chip::BoardFaults>(std::vector<cosim::CarriedFault>{}, *chip_faults_,
                                                   static_cast<chip::BoardAccess&>(*this), chip::Symbols{},
                                                   options_.board.resonator_ppm, options_.start);
    });
}

void TamNode::state(CheckpointWriter& archive) const {
    archive(granted_, *board_, log_, next_reset_);
    if (faults_) archive(*faults_);
}

void TamNode::state(CheckpointReader& archive) {
    archive(granted_, *board_, log_, next_reset_);
    if (faults_) archive(*faults_);
}

std::string TamNode::finish() {
    log_.end(granted_, *board_);
    nlohmann::ordered_json json = tam_json(*board_, log_, warnings_, options_.start);
    if (!options_.faults.empty())
        json["faults"] = board::fault_report(*faults_, board_->analog_faults(), granted_);
    return json.dump();
}

}  // namespace puckloop::tam
