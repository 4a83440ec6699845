#pragma once
// Faults of the air between modules: frames that a receiver does not read, or reads wrong, and frames of a
// foreign network on the channel. Kinds and parameters: cosim/faults/kinds/air_kinds.cpp.

#include "cosim/faults/fault_json.h"
#include "emu/radio/medium.h"
#include "protocols/radio/mesh_frame.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::radio {

class AirFaults {
  public:
    /// `names`: the stations. Throws InputError for one that is not there.
    AirFaults(std::vector<cosim::CarriedFault> faults, std::vector<std::string> names);

    bool empty() const { return carried_.empty(); }
    const std::vector<cosim::CarriedFault>& carried() const { return carried_; }

    /// False if a fault keeps `receiver` from reading a frame, or spoils it so that its check finds it; it
    /// may change `frame`, which is empty for an acknowledgement of the MAC. Asked once for each that it
    /// reads.
    bool read(const Transmission& sent, std::optional<protocols::MeshFrame>& frame, std::size_t receiver);

    /// Puts the frames of foreign networks that begin before `until` on the medium. Times do not decrease by
    /// more than a frame.
    void advance(Medium& medium, cosim::Time until);
    /// A foreign frame has kept `receiver` from reading what `sender` sent, or `sender` from sending.
    void spoilt(const Transmission& foreign, const Transmission& sent, std::size_t receiver);
    void kept_waiting(const Transmission& foreign, std::size_t sender, cosim::Time now);

  private:
    struct Where {
        std::optional<std::size_t> from, to;
    };
    bool meant(std::size_t fault, const Transmission& sent, const protocols::MeshFrame* frame,
               std::size_t receiver) const;
    std::string describe(const Transmission& sent, const protocols::MeshFrame* frame,
                         std::size_t receiver) const;
    bool corrupt(cosim::CarriedFault& fault, std::optional<protocols::MeshFrame>& frame);

    std::vector<cosim::CarriedFault> carried_;
    std::vector<Where> where_;               ///< as carried_
    std::vector<cosim::Time> next_foreign_;  ///< of a clash: its next frame begins then, kNever for others
    std::vector<std::string> names_;
    std::uint64_t foreign_ = 0;
};

}  // namespace puckloop::radio
