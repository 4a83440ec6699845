#pragma once
// Faults sit on links and nowhere else. Each has its own random stream, so that adding one never changes
// what another does, and counts how often it fired.

#include "cosim/core/link.h"
#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "cosim/faults/fault_kind.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// A fault as a scenario asks for it. UART and radio links only; radio frames cannot be Stuck, Rate or Cut.
struct FaultSpec {
    std::string link;  ///< the link's name
    std::string from;  ///< the node whose frames suffer; empty: both ends
    FaultKind kind = FaultKind::Drop;
    double probability = 1.0;     ///< for each frame begun within the window (Cut: for each record), 0..1
    std::uint64_t count = ~0ull;  ///< fires at most so often
    Time begin = 0;               ///< window, by the start bit or preamble: [begin, end)
    Time end = kNever;
    double amount = 0.0;                ///< Delay: seconds, >= 0; Rate: factor > 0 on the bit time
    double again = 0.0;                 ///< Cut: probability that the fault stays for the next record, 0..1
    std::vector<std::uint8_t> bytes{};  ///< only UART frames with one of these values suffer; empty: all
};

/// A message on its way: `message.time` is when it will be delivered.
struct Delivery {
    Message message;
    FaultKind fault = FaultKind::None;
};

/// True of the kinds that a radio frame can suffer.
constexpr bool harms_radio(FaultKind kind) {
    return kind != FaultKind::Stuck && kind != FaultKind::Rate && kind != FaultKind::Cut;
}

/// One fault on one direction of one link.
class LinkFault {
  public:
    virtual ~LinkFault() = default;
    /// May change the deliveries that one sent message became, add to them, or mark them as kept from
    /// arriving; never makes one earlier.
    virtual void apply(std::vector<Delivery>& batch) = 0;
    /// What the fault itself puts on the line, known before the run.
    virtual std::vector<Delivery> preset() const { return {}; }

    std::uint64_t fired() const { return fired_; }

  protected:
    std::uint64_t fired_ = 0;
};

/// `flight` is the link's flight time, `index` the fault's place in the list (names its random stream).
/// Throws InputError for numbers out of range.
std::unique_ptr<LinkFault> make_fault(const FaultSpec& spec, Direction direction, Time flight,
                                      std::uint64_t seed, std::size_t index);

/// "drop on robot0.uart from robot0.pic" for reports.
std::string describe(const FaultSpec& spec);

}  // namespace puckloop::cosim
