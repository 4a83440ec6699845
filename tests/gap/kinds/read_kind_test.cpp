// The file of a described kind: each mistake has one line with file, line and remedy.

#include "base/error.h"
#include "gap/kinds/read_kind.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

const std::string kSound = R"toml(name = "tank"
title = "how full a tank is"

[column.level]
role = "observable"
unit = "V"
range = [0, 5]
mean = "zero + slope * deep"

[column.depth_m]
role = "truth"
unit = "m"
range = [0, 2]

[column.which]
role = "stimulus"
unit = "1"
range = [0, 3]
index = true
default = 0

[formula]
deep = "depth_m * (1 + bend * depth_m)"

[parameter.zero]
unit = "V"
neutral = 0.5
range = [0, 1]
per = "which"

[parameter.slope]
unit = "V/m"
neutral = 1
range = [0.5, 2]
prior_sd = 0.1

[parameter.bend]
unit = "1/m"
neutral = 0
range = [-0.2, 0.2]

[effect.steeper]
title = "the answer is steeper"
parameters = ["slope"]
needs = ["depth_m"]
separated_by = "an empty and a full tank"
)toml";

std::filesystem::path written(const std::string& text) {
    const auto path = puckloop::tests::scratch_path("tank.toml");
    std::ofstream(path) << text;
    return path;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
    const auto path = written(text);
    try {
        (void)read_kind(path);
    } catch (const puckloop::InputError& error) {
        CHECK(error.file() == path.string());
        CHECK(std::string(error.what()).find('\n') == std::string::npos);
        return error.what();
    }
    return "none";
}

/// The sound file with one thing changed.
std::string spoilt(const std::string& from, const std::string& to) {
    return refusal(replaced(kSound, from, to));
}

}  // namespace

TEST_CASE("a sound file is read as it is meant") {
    const Kind kind = read_kind(written(kSound));
    REQUIRE(kind.description() != nullptr);
    const Description& own = *kind.description();
    CHECK(kind == Kind::Described);
    CHECK(kind_name(kind) == "tank");
    CHECK(own.own_columns == 3);
    CHECK(own.columns[0].required);
    CHECK(own.columns[1].required);        // a formula has it
    CHECK_FALSE(own.columns[2].required);  // it has a default
    CHECK(find_column(kind, "battery_v") != nullptr);
    CHECK(own.parameters.size() == 3);
    CHECK(own.parameters[0].per == "which");
    CHECK(own.formulas[0].what == "formula deep");
    REQUIRE(own.effects.size() == 1);
    CHECK(own.effects[0].parameters[0].name == std::string("tank.slope"));
    CHECK(own.effects[0].parameters[0].prior_sd == 0.1);
}

TEST_CASE("the kinds that are shipped are sound") {
    for (const auto& file : std::filesystem::directory_iterator(PUCKLOOP_SOURCE "/scenarios/kinds")) {
        INFO(file.path());
        CHECK_FALSE(read_kind(file.path()).description()->effects.empty());
    }
}

TEST_CASE("every mistake of a kind's file is said with file and line") {
    CHECK_THAT(spoilt("name = \"tank\"", "name = \"ground\""), Contains("line 1") && Contains("simulator"));
    CHECK_THAT(spoilt("name = \"tank\"", "name = \"ir\""), Contains("line 1") && Contains("simulator"));
    CHECK_THAT(spoilt("name = \"tank\"\n", ""), Contains("name"));
    CHECK_THAT(spoilt("* depth_m)\"", "* deph_m)\""),
               Contains("line 23") && Contains("did you mean \"depth_m\""));
    CHECK_THAT(spoilt("slope * deep", "slope * deep * sqrt(-1 - depth_m)"),
               Contains("line 8") && Contains("mean of level is") && Contains("with depth_m ="));
    CHECK_THAT(spoilt("deep = \"depth_m", "deep = \"log(depth_m)"),
               Contains("line 23") && Contains("formula deep is") && Contains("depth_m = 0"));
    CHECK_THAT(spoilt("deep = \"", "a = \"b + deep\"\nb = \"a\"\ndeep = \"0 * a + "),
               Contains("circle") && Contains("line 2"));
    CHECK_THAT(spoilt("deep = \"", "deep = \"deep + "), Contains("line 23") && Contains("circle"));
    CHECK_THAT(spoilt("[column.depth_m]", "[column.depth-m]"),
               Contains("line 10") && Contains("no variable that a formula can have"));
    CHECK_THAT(spoilt("unit = \"m\"", "unit = \"furlong\""), Contains("line 12") && Contains("furlong"));
    CHECK_THAT(spoilt("range = [0, 2]", "range = [2, 0]"), Contains("line 13") && Contains("from 2 to 0"));
    CHECK_THAT(spoilt("range = [0, 2]", "range = [0, nan]"), Contains("line 13") && Contains("finite"));
    CHECK_THAT(spoilt("[parameter.bend]", "[parameter.depth_m]"),
               Contains("line 37") && Contains("column, line 10"));
    CHECK_THAT(spoilt("deep = \"", "slope = \"1\"\ndeep = \""), Contains("parameter, line 32"));
    CHECK_THAT(spoilt("[parameter.bend]", "[parameter.speed]"), Contains("column of all kinds"));
    CHECK_THAT(spoilt(" * (1 + bend * depth_m)", ""), Contains("line 37") && Contains("bend is in no"));
    CHECK_THAT(spoilt("deep = \"", "spare = \"depth_m\"\ndeep = \""),
               Contains("line 23") && Contains("spare is in no observable's"));
    CHECK_THAT(spoilt("role = \"truth\"", "role = \"trueth\""), Contains("line 11"));
    CHECK_THAT(spoilt("slope * deep", "slope * deep + level"), Contains("line 8") && Contains("measured"));
    CHECK_THAT(spoilt("parameters = [\"slope\"]", "parameters = [\"slop\"]"),
               Contains("line 44") && Contains("did you mean \"slope\""));
    CHECK_THAT(spoilt("range = [0.5, 2]\nprior_sd = 0.1", ""), Contains("slope has no range"));
    CHECK_THAT(spoilt("neutral = 1\n", "neutral = 3\n"),
               Contains("line 33") && Contains("outside the range"));
    CHECK_THAT(spoilt("prior_sd = 0.1", "prior_sd = 0"), Contains("prior_sd is not above 0"));
    CHECK_THAT(spoilt("per = \"which\"", "per = \"depth_m\""), Contains("no index column"));
    CHECK_THAT(spoilt("needs = [\"depth_m\"]", "needs = [\"depth\"]"), Contains("did you mean"));
    CHECK_THAT(spoilt("title = \"the", "titel = \"the"), Contains("title"));
    CHECK_THAT(spoilt("mean = \"zero", "noise = \"event\"\nmean = \"zero"), Contains("range of an event"));
    CHECK_THAT(spoilt("mean = \"zero", "noise_factor = \"depth_m\"\nmean = \"zero"),
               Contains("line 8") && Contains("a factor above 0"));
    CHECK_THAT(spoilt("mean = \"zero", "floor = 5\nceiling = 0\nmean = \"zero"), Contains("do not fit"));
    CHECK_THAT(spoilt("role = \"observable\"", "role = \"truth\""), Contains("mean"));
    CHECK_THAT(refusal(""), Contains("name"));
    CHECK_THAT(refusal("name ="), Contains("line 1"));
    CHECK_THAT(refusal(std::string("\0\1\2", 3)), Contains("tank.toml"));
}

TEST_CASE("an event whose formula leaves 0 to 1 is refused with the values") {
    std::string text = replaced(kSound, "range = [0, 5]", "range = [0, 1]\nnoise = \"event\"");
    text = replaced(text, "unit = \"V\"\nrange = [0, 1]", "unit = \"1\"\nrange = [0, 1]");
    CHECK_THAT(refusal(text), Contains("no probability"));
}

TEST_CASE("what is no file") {
    CHECK_THROWS_AS(read_kind("/nowhere/tank.toml"), puckloop::InputError);
    CHECK_THROWS_AS(read_kind("/dev/null"), puckloop::InputError);
    CHECK_THROWS_AS(kind_stated("grond", "", "experiment.toml", "line 1"), puckloop::InputError);
    CHECK(kind_stated("ground", "", "experiment.toml", "line 1") == Kind::Ground);
}
