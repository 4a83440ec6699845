// A verdict follows from a principle, not from what an effect is called: no effect's name and none of its
// parameters' stands in what selects, looks at what is left, or decides.

#include "gap/effects/effect.h"
#include "tests/kit/files.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <set>
#include <string>

namespace fs = std::filesystem;
using namespace puckloop::gap;

namespace {

/// Asks which motor driver a robot has, beside wheels and axles of any size: says so in a caution, decides
/// nothing.
const std::set<std::string> kApart = {"agenda.cpp"};

}  // namespace

TEST_CASE("no effect has a name in selection, diagnosis and decision") {
    const fs::path source = fs::path(PUCKLOOP_SOURCE) / "gap";
    int files = 0;
    for (const char* folder : {"decide", "diagnostics", "evidence", "fit", "fit_test", "pipeline",
                               "predictive", "residual_model", "verdict"})
        for (const auto& entry : fs::directory_iterator(source / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".h" && extension != ".cpp") continue;
            if (kApart.contains(entry.path().filename().string())) continue;
            ++files;
            std::string text = puckloop::tests::text_of(entry.path());
            // Comments may give examples.
            for (auto at = text.find("//"); at != std::string::npos; at = text.find("//", at))
                text.erase(at, text.find('\n', at) - at);
            INFO(entry.path().filename().string());
            for (const Effect& effect : catalogue()) {
                CHECK(text.find("\"" + std::string(effect.name)) == std::string::npos);
                for (const EffectParameter& parameter : effect.parameters)
                    CHECK(text.find("\"" + std::string(parameter.name)) == std::string::npos);
            }
        }
    CHECK(files > 40);
}
