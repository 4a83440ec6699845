// Overlays (`puckloop run --model`) on a scenario with robots, Linux boards and links.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    static const scenarios::Scenario kPair =
        scenarios::read_scenario(PUCKLOOP_SOURCE "/scenarios/rab_pair.toml");
    const InputFile file(input);
    scenarios::Scenario scenario = kPair;
    try {
        scenarios::apply_overlay(scenario, file.path());
        require(scenario.robots.size() == kPair.robots.size(), "an overlay that adds no robots");
    } catch (const InputError& error) {
        // What only the world as a whole shows is said without the file.
        require_refusal(error.what(), "");
    }
}
