#pragma once
// A campaign of a few short cases, for tests of how it is carried out.

#include "tests/end_to_end/kit/workbench.h"

#include <filesystem>
#include <string>

namespace puckloop::tests {

/// The variable that the small campaign takes the folder of its image from.
inline constexpr const char* kImages = "PUCKLOOP_TEST_IMAGES";

/// Ten single cases and three pairs over the robot of Workbench::hello(), 2.6 s each. Sets kImages.
std::filesystem::path small_campaign(const Workbench& bench);

/// `puckloop faults campaign FILE --out NAME` and further words.
Words campaign_words(const Workbench& bench, const std::filesystem::path& file, const std::string& out,
                     const Words& more = {});

/// The table of a campaign; empty if there is none.
std::string table_of(const Workbench& bench, const std::string& out);

/// results.csv of the small campaign as one worker makes it.
std::string reference_table(const Workbench& bench, const std::filesystem::path& file);

}  // namespace puckloop::tests
