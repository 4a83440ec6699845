#include "run/factory/outside_node.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/json.h"
#include "ends/script_end.h"
#include "ends/scripts.h"
#include "ends/text_input.h"
#include "protocols/serial/uart_sampling.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::tools {

namespace {

constexpr cosim::Time kLookEvery = cosim::kMillisecond;
constexpr int kBitsToStop = 9;    // start and eight data bits
constexpr int kBitsOfFrame = 10;  // with the stop bit

cosim::Time period_of(double baud) {
    return static_cast<cosim::Time>(std::llround(1e12 / baud));
}

std::unique_ptr<exec::UartEnd> make_end(const OutsideSpec& outside) {
    const exec::UartSpec& spec = outside.end;
    // A run with such an end is paced by the wall clock, always.
    const exec::LiveOptions live{outside.name, period_of(outside.baud), true};
    switch (spec.kind) {
    case exec::UartSpec::Kind::Script:
        return std::make_unique<exec::ScriptEnd>(
            exec::parse_uart_script(spec.file, exec::read_text_file(spec.file)));
    case exec::UartSpec::Kind::Pty:
        return exec::make_pty_end(live);
    case exec::UartSpec::Kind::Tcp:
        return exec::make_tcp_end(spec.port, live);
    default:
        break;
    }
    throw InputError("", "uart1", "nothing to plug in", "pty, tcp:PORT or script:FILE");
}

}  // namespace

OutsideNode::OutsideNode(const OutsideSpec& spec)
    : name_(spec.name),
      end_(make_end(spec)),
      record_name_(spec.record),
      bit_period_(period_of(spec.baud)),
      quiet_(spec.quiet),
      next_look_(spec.quiet) {
    if (!record_name_.empty()) {
        record_ = new_file(record_name_);
        if (record_ == nullptr) throw RunError(fmt::format("{}: cannot be written", record_name_));
        std::setvbuf(record_, nullptr, _IONBF, 0);  // a crash of the run loses nothing
    }
    if (const std::string text = end_->announcement(); !text.empty())
        fmt::print(stderr, "{}: {}\n", name_, text);
}

OutsideNode::~OutsideNode() {
    if (record_ != nullptr) std::fclose(record_);
}

cosim::Time OutsideNode::next_start() const {
    const cosim::Time next = end_->next();
    return next == cosim::kNever ? cosim::kNever : std::max(next, free_);
}

void OutsideNode::advance(cosim::Time until, std::span<const cosim::Message> inbox,
                          std::vector<cosim::Message>& outbox) {
    for (const cosim::Message& message : inbox) {
        look_outside(message.time);
        send_before(message.time, outbox);
        if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) receive(*frame);
    }
    look_outside(until);
    send_before(until, outbox);
    granted_ = until;
}

void OutsideNode::look_outside(cosim::Time until) {
    for (; end_->live() && next_look_ < until; next_look_ += kLookEvery)
        end_->poll(next_look_, 0);
}

void OutsideNode::send_before(cosim::Time until, std::vector<cosim::Message>& outbox) {
    for (cosim::Time start = next_start(); start < until; start = next_start()) {
        cosim::UartFrame frame;
        frame.bit_period = bit_period_;
        // A byte that came from outside while its time passed begins now.
        frame.start = std::max(start, granted_);
        if (const cosim::Time own = end_->next_bit_period(); own != 0) frame.bit_period = own;
        frame.data = end_->take();
        free_ = frame.start + kBitsOfFrame * frame.bit_period;
        ++sent_;
        outbox.push_back({protocols::stop_bit_start(frame), 0, frame});
    }
}

void OutsideNode::receive(const cosim::UartFrame& frame) {
    const cosim::Time partner = end_->bit_period();
    const protocols::UartReceiver receiver{.bit_period = partner != 0 ? partner : bit_period_};
    for (const auto& character : protocols::sample_frame(frame, receiver, heard_until_)) {
        heard_until_ = character.time;
        const auto byte = static_cast<std::uint8_t>(character.data);
        ++received_;
        if (character.framing_error) ++framing_errors_;
        // What a live end hears is paced by the wall clock, which does not count yet.
        if (!end_->live() || character.start >= quiet_)
            end_->receive(byte, !character.framing_error, character.start);
        if (record_ != nullptr && std::fputc(byte, record_) == EOF)
            throw RunError(fmt::format("{}: cannot be written", record_name_));
    }
}

cosim::Time OutsideNode::earliest_output(cosim::PortIndex /*port*/) const {
    if (end_->live()) return next_start() == cosim::kNever ? std::max(granted_, next_look_) : granted_;
    return std::max(cosim::later(next_start(), kBitsToStop * bit_period_), granted_);
}

std::string OutsideNode::finish() {
    end_->finish();
    nlohmann::ordered_json json = {
        {"sent", sent_}, {"received", received_}, {"framing_errors", framing_errors_}};
    if (end_->live()) {
        const exec::EndLosses lost = end_->losses();
        json["unconnected"] = lost.unconnected;
        json["unread"] = lost.unread;
        if (lost.unread > 0)
            json["warnings"] = nlohmann::ordered_json::array({exec::text_of(lost, end_->announcement())});
    }
    return json.dump();
}

}  // namespace puckloop::tools
