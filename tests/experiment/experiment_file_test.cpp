// Experiment files and files of scores: what they mean, and what is refused with file and line.

#include "base/error.h"
#include "campaigns/experiment/experiment_file.h"
#include "campaigns/experiment/reference.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::swarm;
using puckloop::scenarios::TemporaryFile;

namespace {

const std::string kHead = "[experiment]\nscenario = \"a.toml\"\n";

std::string problem_of(const std::string& text) {
    const TemporaryFile file(text);
    try {
        read_experiment(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

std::string problem_of_scores(const std::string& text) {
    const TemporaryFile file(text);
    try {
        read_reference(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(file.path().size() + 2);
    }
    return "accepted";
}

}  // namespace

TEST_CASE("an experiment's runs are programs by conditions by seeds, in that order") {
    const TemporaryFile file(
        kHead + "seeds = [7, 2]\nbetter = \"less\"\n[[program]]\nname = \"p\"\nset = { n = 3, s = "
                "\"x y\", f = true }\nfirmware = [\"pic=dir/a.hex\", \"rab=own\"]\n[[program]]\n"
                "name = \"q\"\nlinux = [\"./control\", \"./argument\"]\n[[condition]]\nname = "
                "\"c\"\n[[condition]]\nname = \"d\"\nmodel = \"m.toml\"\n");
    const Experiment experiment = read_experiment(file.path());
    const auto folder = std::filesystem::path(file.path()).parent_path();
    CHECK(experiment.scenario == folder / "a.toml");
    CHECK(experiment.seeds == std::vector<std::uint64_t>{2, 7});
    CHECK(experiment.more_is_better == false);
    CHECK(experiment.programs.at(0).variables == std::vector<std::string>{"f=true", "n=3", "s=x y"});
    CHECK(experiment.programs.at(0).firmware ==
          std::vector<std::string>{"pic=" + (folder / "dir/a.hex").string(), "rab=own"});
    CHECK(experiment.programs.at(1).program ==
          std::vector<std::string>{(folder / "control").string(), "./argument"});
    CHECK(experiment.conditions.at(1).model == folder / "m.toml");
    const std::vector<Run> runs = runs_of(experiment);
    REQUIRE(runs.size() == 8);
    CHECK(runs[2].id == 3);
    CHECK(runs[2].condition == 1);
    CHECK(runs[3].seed == 7);
    CHECK(runs[4].program == 1);
    CHECK(run_from_json(to_json(runs[3])).seed == 7);
}

TEST_CASE("without programs and conditions there is one of each, and a number of seeds counts from 1") {
    const TemporaryFile file(kHead + "seeds = 3\n");
    const Experiment experiment = read_experiment(file.path());
    CHECK(experiment.seeds == std::vector<std::uint64_t>{1, 2, 3});
    CHECK(runs_of(experiment).size() == 3);
}

TEST_CASE("an experiment file that cannot be is refused with its line") {
    CHECK(problem_of("[experimnt]\n").starts_with("line 1: "));
    CHECK(problem_of(kHead).find("'seeds' is missing") != std::string::npos);
    CHECK(problem_of(kHead + "seeds = 0\n").starts_with("line 3: experiment: seeds is out of range"));
    CHECK(problem_of(kHead + "seeds = [1, 1]\n").starts_with("line 3: experiment: seed 1 is there twice"));
    CHECK(problem_of(kHead + "seeds = \"many\"\n").starts_with("line 3: experiment: seeds has no number"));
    CHECK(problem_of(kHead + "seeds = 1\nscore = \"mission\"\n")
              .starts_with("line 4: experiment: 'mission' is no"));
    CHECK(problem_of(kHead + "seeds = 1\nduration = \"0 s\"\n")
              .starts_with("line 4: experiment: duration is out"));
    CHECK(problem_of(kHead + "seeds = 1\n[[program]]\nname = \"a\"\n[[program]]\nname = \"a\"\n")
              .starts_with("line 7: program 2: there is another 'a'"));
    CHECK(problem_of(kHead + "seeds = 1\n[[program]]\nname = \"a,b\"\n")
              .starts_with("line 5: program 1: the name"));
    CHECK(problem_of(kHead + "seeds = 1\n[[program]]\nname = \"a\"\nset = { n = [1] }\n")
              .starts_with("line 6: program 1: 'n' is no single value"));
    CHECK(problem_of(kHead + "seeds = 1\n[[condition]]\nname = \"a\"\nprogram = \"x\"\n")
              .starts_with("line 6: condition 1: unknown key 'program'"));
}

TEST_CASE("a file of scores: its columns, its rows, and what is refused with its line") {
    const TemporaryFile file("study,program,condition,score\nx,\"p\",c,12\nx,p,c,\nx,q,c,3.5\nx,p,c,-1\n\n");
    const Reference reference = read_reference(file.path());
    CHECK(reference.has_conditions);
    CHECK(reference.scores.at({"p", "c"}) == std::vector<double>{12, -1});
    CHECK(reference.scores.at({"q", "c"}) == std::vector<double>{3.5});
    CHECK(problem_of_scores("").starts_with("line 1: the file is empty"));
    CHECK(problem_of_scores("program,value\np,1\n").starts_with("line 1: there is no column 'score'"));
    CHECK(problem_of_scores("program,score\np,1\np,x\n").starts_with("line 3: 'x' is no score"));
    CHECK(problem_of_scores("program,score\np,1,2\n").starts_with("line 2: it has 3 cells, the header 2"));
    CHECK(problem_of_scores("program,score\np,\n").find("no row with a score") != std::string::npos);
    CHECK_THROWS_AS(read_reference("/nowhere/scores.csv"), InputError);
}
