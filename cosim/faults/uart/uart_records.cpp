// Faults of records: bytes that a UART sends without a pause.

#include "cosim/faults/frame_fault.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {

/// Radio or line drop out somewhere in a record, for the rest of it. Where is even over the length of the
/// record before.
class Cut : public LinkFault {
  public:
    explicit Cut(const FaultPlan& plan)
        : spec_(plan.spec),
          sender_(plan.site.sender),
          again_(spec_.parameters.number("again")),
          random_(plan.random) {}

    void apply(std::vector<Delivery>& batch, const Sending& sending) override {
        for (Delivery& delivery : batch) {
            const auto* frame = std::get_if<UartFrame>(&delivery.message.payload);
            if (!frame || keeps_from_arriving(delivery.fault)) continue;
            const std::uint32_t place = records_.place(*frame);
            if (place == 0) begin_record(frame->start);
            if (!cut_ || place < place_) continue;
            if (place == place_) {
                ++fired_;
                evidence_.fire({frame->start, sending.index, sender_, text_of(delivery.message.payload)},
                               sending.delivery);
            }
            delivery.fault = FaultKind::Cut;
        }
    }

  private:
    void begin_record(Time start) {
        const double stays = cut_ ? again_ : 0.0;
        const double chance = spec_.probability + (1 - spec_.probability) * stays;
        const bool open = start >= spec_.begin && start < spec_.end && fired_ < spec_.count;
        cut_ = open && random_.uniform() < chance;
        if (cut_) place_ = random_.below(std::max<std::uint64_t>(records_.last_length(), 1));
    }

    FaultSpec spec_;
    std::string sender_;
    double again_;
    RandomStream random_;
    RecordCount records_;
    std::uint64_t fired_ = 0;
    bool cut_ = false;
    std::uint64_t place_ = 0;  // the first byte of the record that is lost
};

/// Of a record only the first bytes arrive.
class Truncate : public LinkFault {
  public:
    explicit Truncate(const FaultPlan& plan)
        : trigger_(plan.spec, plan.random),
          sender_(plan.site.sender),
          keep_(static_cast<std::uint32_t>(plan.spec.parameters.number("keep"))) {}

    void apply(std::vector<Delivery>& batch, const Sending& sending) override {
        for (Delivery& delivery : batch) {
            const auto* frame = std::get_if<UartFrame>(&delivery.message.payload);
            if (!frame || keeps_from_arriving(delivery.fault)) continue;
            const std::uint32_t place = records_.place(*frame);
            if (place == 0) short_ = false;
            // A record that ends before is none that can be truncated.
            if (place == keep_) short_ = trigger_.fires(frame->start);
            if (!short_) continue;
            if (place == keep_)
                evidence_.fire({frame->start, sending.index, sender_, text_of(delivery.message.payload)},
                               sending.delivery);
            delivery.fault = FaultKind::Truncate;
        }
    }

  private:
    Trigger trigger_;
    std::string sender_;
    std::uint32_t keep_;
    RecordCount records_;
    bool short_ = false;
};

}  // namespace

std::unique_ptr<LinkFault> make_record_fault(const FaultPlan& plan) {
    if (plan.kind.mark == FaultKind::Cut) return std::make_unique<Cut>(plan);
    if (plan.kind.mark == FaultKind::Truncate) return std::make_unique<Truncate>(plan);
    return nullptr;
}

}  // namespace puckloop::cosim
