#include "emu/tam_avr/tam_node.h"

#include "base/json.h"
#include "emu/tam_avr/fuse_check.h"
#include "emu/tam_avr/tam_json.h"
#include "protocols/serial/uart_sampling.h"

#include <algorithm>

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
    : BoardNode(options.board.name,
                {{"console", cosim::PortKind::Uart},
                 {"xbee", cosim::PortKind::Uart},
                 {"pins", cosim::PortKind::Signals},
                 {"world", cosim::PortKind::Signals},
                 {"ir", cosim::PortKind::Signals}},
                options.resets),
      options_(options),
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

void TamNode::run_board(Time until) {
    const Time board_until = to_board(until);
    board_->run_until(board_until);
    if (!faults_) return;
    while (board_->powered() && board_->chip().stopped_at()) {
        faults_->arrived(from_board(board_->now()));
        board_->run_until(board_until);
    }
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
    if (board_->powered()) next = std::min(next, next_reset().value_or(cosim::kNever));
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
    find_next_reset();
    board::load_faults(archive, faults_, granted_, [this] {
        chip_faults_.emplace(board_->chip());
        return std::make_unique<chip::BoardFaults>(std::vector<cosim::CarriedFault>{}, *chip_faults_,
                                                   static_cast<chip::BoardAccess&>(*this), chip::Symbols{},
                                                   options_.board.resonator_ppm, options_.start);
    });
}

void TamNode::state(CheckpointWriter& archive) const {
    list_node(archive, *this);
    archive(*board_, log_);
    if (faults_) archive(*faults_);
}

void TamNode::state(CheckpointReader& archive) {
    list_node(archive, *this);
    archive(*board_, log_);
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
