#include "tests/experiment/small_experiment.h"

namespace puckloop::tests {

std::filesystem::path small_experiment(const Workbench& bench) {
    return bench.file("small.toml",
                      "[experiment]\nscenario = \"" PUCKLOOP_SOURCE
                      "/scenarios/aggregation.toml\"\nduration = \"2.5 s\"\nseeds = 3\n"
                      "[[program]]\nname = \"aggregate\"\nset = { robots = 3 }\n"
                      "[[program]]\nname = \"still\"\nset = { robots = 3, behaviour = \"still\" }\n");
}

Words experiment_words(const Workbench& bench, const std::filesystem::path& file, const std::string& out,
                       const Words& more) {
    Words words{"experiment", file.string(), "--out", bench.out(out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

}  // namespace puckloop::tests
