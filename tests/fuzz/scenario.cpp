// Scenarios: TOML and what its tables mean.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/fuzz/target.h"

void puckloop::fuzz::run_input(Input input) {
    const InputFile file(input);
    try {
        scenarios::read_scenario(file.path());
    } catch (const InputError& error) {
        // A file that the scenario names may be the one that is refused.
        require_refusal(error.what(), "");
    }
}
