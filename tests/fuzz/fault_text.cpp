// Faults in one line, as `--fault` takes them.

#include "base/error.h"
#include "scenarios/reader/faults/fault_tables.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    static const scenarios::Scenario kScenario =
        scenarios::read_scenario(PUCKLOOP_SOURCE "/scenarios/rab_pair.toml");
    scenarios::Scenario scenario = kScenario;
    try {
        scenarios::add_fault(text_of(input), scenario);
    } catch (const InputError& error) {
        require_refusal(error.what(), "");
    }
}
