#pragma once
// The bases of faults that make frames suffer one by one; the kinds say how.

#include "cosim/faults/faults.h"
#include "cosim/faults/frame_match.h"
#include "cosim/faults/trigger.h"

#include <limits>
#include <memory>
#include <vector>

namespace puckloop::cosim {

/// What a kind is made from.
struct FaultPlan {
    FaultSpec spec;  ///< complete
    const KindInfo& kind;
    WireSite site;
    RandomStream random;
};

/// Calls work(frame) for a UART or radio frame; for anything else the result is `Result{}`.
template <class Result>
Result with_frame(Payload& payload, auto work) {
    if (auto* frame = std::get_if<UartFrame>(&payload)) return work(*frame);
    if (auto* radio = std::get_if<RadioFrame>(&payload)) return work(*radio);
    return Result{};
}

/// Start of a frame.
Time start_of(const Payload& payload);
/// "0x41", "break", "a radio frame of 12 octets".
std::string text_of(const Payload& payload);
/// Frame and delivery come later by `delay`, 0 or more.
void shift(Message& message, Time delay);

class FrameFault : public LinkFault {
  public:
    explicit FrameFault(FaultPlan plan);

    void apply(std::vector<Delivery>& batch, const Sending& sending) final;

  protected:
    /// The frame suffers; it is marked already.
    virtual void harm(std::size_t i, std::vector<Delivery>& batch) = 0;
    /// Whether a frame can suffer at all just now; those that cannot are no candidates.
    virtual bool can_suffer(const Payload&) const { return true; }
    /// After each sent message.
    virtual void after(std::vector<Delivery>&) {}

    /// Something that the fault itself will put on the line; fired, if it arrives before the end of the run.
    /// Of preset() only. `what`: for the evidence; empty: the kind's name.
    Delivery own(const UartFrame& frame, FaultKind mark, std::string what = {});

    const FaultSpec& spec() const { return plan_.spec; }
    const WireSite& site() const { return plan_.site; }
    /// Nominal bit time of the link.
    Time bit_time() const;
    Trigger& trigger() { return trigger_; }
    RandomStream& random() { return trigger_.random(); }

  private:
    FaultPlan plan_;
    Trigger trigger_;
    FrameMatch match_;
};

/// A fault that makes frames later or longer: those behind are pushed back, as no line carries two at once.
class QueuedFault : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void after(std::vector<Delivery>& batch) override;

  private:
    Time free_ = std::numeric_limits<Time>::min() / 2;  // the line is, from then on
};

// The families of kinds; nullptr for a kind that is not theirs.
std::unique_ptr<LinkFault> make_typed_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_byte_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_record_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_level_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_invert_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_timing_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_wiring_fault(const FaultPlan& plan);
std::unique_ptr<LinkFault> make_radio_fault(const FaultPlan& plan);

}  // namespace puckloop::cosim
