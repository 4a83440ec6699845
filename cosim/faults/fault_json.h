#pragma once
// Faults that a node carries out travel in its description, and what became of them in its report.

#include "cosim/faults/evidence.h"
#include "cosim/faults/spec/fault_spec.h"
#include "cosim/faults/trigger.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <vector>

namespace puckloop::cosim {

/// One fault of a node: its specification, complete, and its trigger with its own random stream.
struct CarriedFault {
    FaultSpec spec;
    Trigger trigger;
    Evidence evidence{};

    /// Counts and reports what happened to what at `time`.
    void fired(Time time, std::uint64_t index, std::string what) {
        evidence.fire({time, index, {}, std::move(what)}, time);
    }
    template <class Archive>
    void state(Archive& archive) {
        archive(trigger, evidence);
    }
};

/// For the "faults" of a node's description; `index` is the fault's place in the run's list.
nlohmann::ordered_json fault_to_json(const FaultSpec& spec, std::uint64_t seed, std::size_t index);
/// The other way; `list` is the array "faults" or null. Throws InputError for what is no fault.
std::vector<CarriedFault> faults_from_json(const nlohmann::ordered_json& list);

/// For "faults" in a node's report (Node::finish()): [{"name", "fired", "firings": [...]}, ...]. Nothing that
/// happened at `end` or later is reported.
nlohmann::ordered_json fault_results(const std::vector<CarriedFault>& faults, Time end = kNever);
/// Reads one entry of that list into the fault's report.
void add_fault_result(FaultReport& report, const nlohmann::ordered_json& result);

}  // namespace puckloop::cosim
