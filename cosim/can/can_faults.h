#pragma once
// The faults of one CAN bus (kinds and parameters: cosim/faults/kinds/can_kinds.cpp): which bits of which
// frames are read inverted and by whom, who is cut off, when the wire is held; and the evidence.

#include "cosim/faults/fault_json.h"
#include "protocols/can/can_frame.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// A bit of a frame that is read inverted.
struct CanFlip {
    int bit = 0;                       ///< the start of frame is 0, stuff bits count
    std::optional<std::size_t> who{};  ///< the only controller that reads it so; none: all do
};

class CanFaults {
  public:
    /// `controllers`: their names by index. Throws InputError for a fault of one that is not there.
    CanFaults(std::vector<CarriedFault> faults, std::vector<std::string> controllers);

    bool empty() const { return faults_.empty(); }
    /// The next instant after `time` at which the wire is held or let go, or somebody is cut off or joined.
    Time next_change(Time time) const;
    bool held_dominant(Time now) const { return holds(Kind::Dominant, now); }
    /// This controller and the others do not hear each other.
    bool cut_off(std::size_t controller, Time now) const;
    /// A held wire or a cut made a difference to a controller that takes part.
    void felt_dominant(Time now, std::size_t controller);
    void felt_cut(Time now, std::size_t controller);

    /// `sender` has the bus to itself with a frame that began at `start`.
    std::vector<CanFlip> strike(std::size_t sender, const protocols::CanFrame& frame,
                                const protocols::CanBits& bits, Time start);
    /// `receiver` took the frame, and its program is not informed.
    bool drops(std::size_t sender, std::size_t receiver, const protocols::CanFrame& frame, Time start);

    /// The run is over at `now`: a wire held dominant counts, whether a controller took part or not.
    void conclude(Time now);
    const std::vector<CarriedFault>& carried() const { return carried_; }

  private:
    enum class Kind : std::uint8_t { Flip, Drop, Dominant, Recessive, Disconnect };
    /// Beside the CarriedFault with the same index.
    struct Fault {
        Kind kind = Kind::Flip;
        std::optional<std::size_t> from{}, to{};
        std::optional<std::uint32_t> id{};
        Time felt = kNever;  ///< when it was last counted
    };
    bool holds(Kind kind, Time now) const;
    bool meant(const Fault& fault, std::size_t sender, const protocols::CanFrame& frame) const;
    void felt(std::size_t index, Time now, const std::string& what);

    std::vector<CarriedFault> carried_;
    std::vector<Fault> faults_;
    std::vector<std::string> controllers_;
    std::uint64_t frames_ = 0;
};

/// "0x123 2 bytes" for reports; an extended identifier has eight digits.
std::string can_text(const protocols::CanFrame& frame);

}  // namespace puckloop::cosim
