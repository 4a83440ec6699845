#include "cosim/faults/faults.h"

#include "base/error.h"
#include "cosim/faults/frame_fault.h"

#include <fmt/format.h>

namespace puckloop::cosim {

std::unique_ptr<LinkFault> make_fault(const FaultSpec& spec, const WireSite& site, std::uint64_t seed,
                                      std::size_t index) {
    const auto place = fmt::format("fault on link {}", spec.link);
    const KindInfo* kind = find_kind(spec.kind, site.place);
    if (!kind)
        throw InputError(
            "", place,
            fmt::format("{} on a {} link", spec.kind, site.place == PlaceKind::Radio ? "radio" : "UART"),
            kinds_of(site.place));
    FaultPlan plan{spec, *kind, site, fault_stream(spec, seed, index, static_cast<int>(site.direction))};
    complete(plan.spec, *kind);
    check_fault(plan.spec, *kind);
    for (auto make : {make_radio_fault, make_typed_fault, make_byte_fault, make_record_fault,
                      make_level_fault, make_invert_fault, make_timing_fault, make_wiring_fault})
        if (auto fault = make(plan)) return fault;
    throw InputError("", place, fmt::format("nobody carries out {}", spec.kind));
}

}  // namespace puckloop::cosim
