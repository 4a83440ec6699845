// A run as a test suite in the forms that CI reads.

#include "run/expectations/test_report.h"

#include <catch2/catch.hpp>
#include <pugixml.hpp>

using namespace puckloop::tools;

namespace {
TestSuite suite() {
    return {.name = "hello",
            .trouble = {},
            .scenario = "hello.toml",
            .out = "out/hello",
            .wall_s = 1.5,
            .results = {{"a <b> & \"c\"", "", "line 3", "robot0", true, "seen", 1.0},
                        {"no. #2\x01", "", "line 9", "robot0.uart", false, "not seen", {}}}};
}
}  // namespace

TEST_CASE("JUnit's file has a case for the run and one for each table, whatever their names") {
    pugi::xml_document document;
    const std::string text = junit_text(suite());
    REQUIRE(document.load_string(text.c_str()));
    const pugi::xml_node root = document.child("testsuites").child("testsuite");
    CHECK(root.attribute("tests").as_int() == 3);
    CHECK(root.attribute("failures").as_int() == 1);
    std::vector<std::string> names, failures;
    for (const pugi::xml_node one : root.children("testcase")) {
        names.push_back(one.attribute("name").value());
        failures.push_back(one.child("failure").attribute("message").value());
    }
    CHECK(names == std::vector<std::string>{"the run goes on to its end", "a <b> & \"c\"", "no. #2\\x01"});
    CHECK(failures ==
          std::vector<std::string>{"", "", "hello.toml: line 9: expected that no. #2\\x01: not seen"});
}

TEST_CASE("TAP's lines are numbered, and a number sign in a name begins no directive") {
    TestSuite failed = suite();
    failed.trouble = "node robot0.pic has not answered";
    CHECK(tap_text(failed) == "TAP version 13\n1..3\n"
                              "not ok 1 - the run goes on to its end\n# node robot0.pic has not answered\n"
                              "ok 2 - a <b> & \"c\"\n"
                              "not ok 3 - no. \\#2\\x01\n"
                              "# hello.toml: line 9: expected that no. #2\\x01: not seen\n");
}
