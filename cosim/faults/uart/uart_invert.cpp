// A UART's line whose levels are the other ones during a window: that at rest, and those of its frames.

#include "cosim/faults/frame_fault.h"

#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <utility>

namespace puckloop::cosim {

namespace {

/// Of frames that are on the line when the window begins or ends, the part within it is inverted, to the
/// picosecond: such a frame becomes a series of levels.
class Invert : public LinkFault {
  public:
    explicit Invert(const FaultPlan& plan) : begin_(plan.spec.begin), end_(plan.spec.end), site_(plan.site) {}

    /// The line at rest goes low, and high again. A picosecond early, so that a frame that changes its level
    /// at the same time has the line.
    std::vector<Delivery> preset() override {
        std::vector<Delivery> levels;
        const auto put = [&](Time at, bool high) {
            UartFrame frame;
            frame.start = std::max<Time>(0, at - 1);
            frame.bit_period = std::max<Time>(1, site_.flight / kFlightBits);
            set_level(frame, high);
            const Time delivery = later(later(frame.start, site_.flight), site_.latency);
            levels.push_back({Message{delivery, 0, frame}, FaultKind::Invert});
        };
        put(begin_, false);
        evidence_.foresee({begin_, 0, site_.sender, "invert"}, levels.front().message.time);
        if (end_ != kNever) put(end_, true);
        return levels;
    }

    void apply(std::vector<Delivery>& batch, const Sending& sending) override {
        const std::size_t count = batch.size();
        for (std::size_t i = 0; i < count; ++i) {
            auto* frame = std::get_if<UartFrame>(&batch[i].message.payload);
            if (!frame || keeps_from_arriving(batch[i].fault)) continue;
            const Time start = frame->start, end = start + frame_time(*frame);
            if (end <= begin_ || start >= end_) continue;
            evidence_.fire({start, sending.index, site_.sender, text_of(batch[i].message.payload)},
                           sending.delivery);
            batch[i].fault = FaultKind::Invert;
            if (start >= begin_ && end <= end_)
                frame->line ^= kLineInverted | kLineRestsLow;
            else
                tear(i, batch);
        }
    }

  private:
    static constexpr Time kFlightBits = 9;

    static void set_level(UartFrame& frame, bool high) {
        frame.is_break = 1;
        frame.line = high ? kLineInverted : kLineRestsLow;
    }

    /// Frames of one level each, as long as that level lasts, in place of frame i.
    void tear(std::size_t i, std::vector<Delivery>& batch) const {
        const Delivery was = batch[i];
        const UartFrame& frame = std::get<UartFrame>(was.message.payload);
        const Time end = frame.start + frame_time(frame);
        const auto level = [&](Time time) {
            return protocols::line_is_mark(frame, time) != (time >= begin_ && time < end_);
        };
        const auto next_change = [&](Time time) {
            Time next = protocols::next_change(frame, time);
            for (const Time edge : {begin_, end_})
                if (edge > time) next = std::min(next, edge);
            return std::min(next, end);
        };
        bool first = true;
        for (Time time = frame.start; time < end;) {
            UartFrame piece;
            piece.start = time;
            const bool high = level(time);
            while (time < end && level(time) == high)
                time = next_change(time);
            const Time bits = bits_of(piece);
            piece.bit_period = std::max<Time>(1, (time - piece.start + bits - 1) / bits);
            set_level(piece, high);
            Delivery delivery = was;
            delivery.message.payload = piece;
            if (std::exchange(first, false))
                batch[i] = delivery;
            else
                batch.push_back(delivery);
        }
    }

    Time begin_, end_;
    WireSite site_;
};

}  // namespace

std::unique_ptr<LinkFault> make_invert_fault(const FaultPlan& plan) {
    if (plan.kind.mark != FaultKind::Invert) return nullptr;
    return std::make_unique<Invert>(plan);
}

}  // namespace puckloop::cosim
