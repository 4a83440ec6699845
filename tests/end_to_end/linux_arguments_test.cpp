// `--linux PROGRAM [ARG]...`: which words are the program's.

#include "run/plan/linux_arguments.h"
#include "tests/kit/shell.h"

#include <catch2/catch.hpp>

#include <sstream>
#include <string>
#include <vector>

using puckloop::tools::pack_linux_arguments;
using Words = std::vector<std::string>;

TEST_CASE("words without --linux stay as they are") {
    const Words words{"run", "x.toml", "--duration", "5", "-c", "y"};
    CHECK(pack_linux_arguments(words) == words);
    CHECK(pack_linux_arguments({}).empty());
}

TEST_CASE("what follows --linux is the program and its arguments, options included") {
    CHECK(pack_linux_arguments({"run", "x.toml", "--linux", "./argos", "-c", "a.argos", "-i", "avoid"}) ==
          Words{"run", "x.toml", "--linux=./argos", "--linux-arg=-c", "--linux-arg=a.argos", "--linux-arg=-i",
                "--linux-arg=avoid"});
}

TEST_CASE("an option of run ends the program's arguments") {
    CHECK(pack_linux_arguments({"--linux", "p", "-x", "--in-process", "--out", "o"}) ==
          Words{"--linux=p", "--linux-arg=-x", "--in-process", "--out", "o"});
    CHECK(pack_linux_arguments({"--linux", "p", "--out=o", "-x"}) == Words{"--linux=p", "--out=o", "-x"});
    // Only whole names do: the program's --outline is its own.
    CHECK(pack_linux_arguments({"--linux", "p", "--outline"}) == Words{"--linux=p", "--linux-arg=--outline"});
}

TEST_CASE("after -- everything is the program's") {
    CHECK(pack_linux_arguments({"--linux", "p", "-a", "--", "--duration", "60", "--", "-z"}) ==
          Words{"--linux=p", "--linux-arg=-a", "--linux-arg=--duration", "--linux-arg=60", "--linux-arg=--",
                "--linux-arg=-z"});
}

TEST_CASE("a last --linux is left for the parser to refuse") {
    CHECK(pack_linux_arguments({"run", "--linux"}) == Words{"run", "--linux"});
}

TEST_CASE("empty arguments and arguments with spaces or = arrive whole") {
    CHECK(pack_linux_arguments({"--linux", "p", "", "a b", "k=v"}) ==
          Words{"--linux=p", "--linux-arg=", "--linux-arg=a b", "--linux-arg=k=v"});
}

TEST_CASE("every option of run's help is known to end the program's arguments") {
    std::istringstream help(puckloop::tests::run_in_shell(PUCKLOOP_PROGRAM " run --help").output);
    int seen = 0;
    for (std::string text; std::getline(help, text);) {
        const auto at = text.find("--");
        // An option's own line begins with it, perhaps behind a short name.
        if (at == std::string::npos || text.find_first_not_of(' ') + 3 < at) continue;
        const std::string option = text.substr(at, text.find_first_of(" =:\n", at) - at);
        if (option == "--help") continue;
        INFO(option);
        CHECK(pack_linux_arguments({"--linux", "p", option}).back().starts_with(option));
        ++seen;
    }
    CHECK(seen > 10);
}
