#pragma once
// Faults of IRcom's medium as they come to the node: by its description.

#include "base/json.h"
#include "cosim/faults/fault_json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "tests/ircom/worlds.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace puckloop::ircom_test {

inline cosim::FaultSpec ircom_fault(const std::string& kind) {
    cosim::FaultSpec spec;
    spec.node = "ircom";
    spec.kind = kind;
    spec.name = kind;
    return spec;
}

inline std::vector<cosim::CarriedFault> carried(std::vector<cosim::FaultSpec> specs) {
    auto list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const cosim::KindInfo* kind = cosim::find_kind(specs[i].kind, cosim::PlaceKind::Ircom);
        REQUIRE(kind != nullptr);
        cosim::complete(specs[i], *kind);
        cosim::check_fault(specs[i], *kind);
        list.push_back(cosim::fault_to_json(specs[i], 1, i));
    }
    return cosim::faults_from_json(list);
}

}  // namespace puckloop::ircom_test
