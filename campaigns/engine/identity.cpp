#include "campaigns/engine/identity.h"

#include "campaigns/jobs/input_files.h"
#include "cosim/resume/state_file.h"

namespace puckloop::faults {

using nlohmann::json;

std::string identity_of(const Campaign& campaign, const scenarios::Scenario& scenario) {
    jobs::InputFiles inputs;
    inputs.add(campaign.file);
    inputs.add(campaign.scenario);
    inputs.add_scenario(scenario);
    const json identity{{"files", inputs.files()},
                        {"firmware", campaign.firmware},
                        {"program", campaign.program},
                        {"build", cosim::build_id()}};
    return identity.dump(-1, ' ', true, json::error_handler_t::replace);
}

}  // namespace puckloop::faults
