#pragma once
// What the results of a campaign hang on.

#include "campaigns/engine/campaign_file.h"
#include "scenarios/description/scenario.h"

namespace puckloop::faults {

/// Text that changes when the campaign, its scenario, an image or program of it, or this build of puckloop
/// does. Files count by content, so that a program that was built anew is another one.
std::string identity_of(const Campaign& campaign, const scenarios::Scenario& scenario);

}  // namespace puckloop::faults
